"""
Plays messages to nodes on real ROS and records what they publish. Runs under Debian's Python.

It reads messages from its standard input (see `runner`), publishes them, and waits after each
picture until the nodes have dealt with it: nobody works any more, and who answers has answered. So
no picture is lost to a short queue, and two runs give the same. The simulated clock follows the
messages' stamps. With a rate, pictures come at that rate and nobody waits for anybody.

This file imports nothing of ours: it is executed by its path.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import struct
import sys
import threading
import time
import warnings
import xmlrpc.client
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import rosbag
import rosgraph
import rospy
from rosgraph_msgs.msg import Clock
from roslib.message import get_message_class
from std_msgs.msg import String

if TYPE_CHECKING:
    from collections.abc import Iterator

ME = "/camera"
MASTER = rosgraph.Master(ME)
HEAD = struct.Struct("<QHHI")  # stamp in ns; lengths of topic, type and message
QUIET, TICK = 3, 0.004  # looks in a row at which nobody works; seconds between them
PATIENCE = 30.0  # wall seconds for a node to subscribe, or to deal with one picture
IDLE = 12  # looks in a row at which a node does nothing and does not subscribe
STEPS = 4  # of the clock, from a picture without an answer to the next
AFTER, STEPS_AFTER = 1.0, 10  # simulated seconds after the last message
IMAGE, LOG = "sensor_msgs/Image", "/rosout"
NOT_THEIRS = {"/rosout_agg", "/clock"}
OUTCOME = "/offline_ros/outcome"  # as `offline_ros` names it

Message = tuple[int, str, str, bytes]


def read_messages(stream: BinaryIO) -> Iterator[Message]:
    """Yield (stamp, topic, type, serialized message) until the stream ends."""
    while head := stream.read(HEAD.size):
        stamp, *lengths = HEAD.unpack(head)
        topic, kind, data = (stream.read(length) for length in lengths)
        yield stamp, topic.decode(), kind.decode(), data


def from_ns(stamp: int) -> Any:  # noqa: ANN401  (rospy has no types)
    """Give a stamp as ROS's own time."""
    return rospy.Time(*divmod(stamp, 10**9))


def busy(pids: list[int]) -> bool:
    """Tell whether a thread of these processes works or waits for a processor; not this one."""
    mine = str(threading.get_native_id())
    for pid in pids:
        try:
            for task in Path(f"/proc/{pid}/task").iterdir():
                state = (task / "stat").read_text().rpartition(")")[2].split()[0]
                if state in "RD" and task.name != mine:
                    return True
        except OSError:  # it has just ended
            continue
    return False


def process_of(node: str) -> int:
    """Give a node's process id; 0 for one that does not answer."""
    try:
        reply: Any = xmlrpc.client.ServerProxy(MASTER.lookupNode(node)).getPid(ME)
        return int(reply[2])
    except (OSError, rosgraph.MasterError):
        return 0


class Recorder:
    """Writes down what other nodes publish, at the clock's time."""

    def __init__(self, path: str, keep: list[str]) -> None:
        self.bag = rosbag.Bag(path, "w")
        self.open = True
        self.keep = {*keep, LOG} if keep else set()
        self.lock = threading.Lock()
        self.subscribers: dict[str, Any] = {}
        self.now = rospy.Time(0)
        self.answers = 0
        self.first_answer = self.last_answer = 0.0
        self.complaint = ""

    def listen(self, offered: list[tuple[str, list[str]]]) -> None:
        """Subscribe to what is new among topics, and wait until the connections stand."""
        for topic, nodes in offered:
            known = topic in NOT_THEIRS or topic in self.subscribers
            if not known and set(nodes) - {ME, LOG}:
                self.subscribers[topic] = rospy.Subscriber(
                    topic, rospy.AnyMsg, self.record, callback_args=topic, tcp_nodelay=True
                )
        deadline = time.monotonic() + 2
        while time.monotonic() < deadline and not all(
            subscriber.get_num_connections() for subscriber in self.subscribers.values()
        ):
            time.sleep(TICK)

    def record(self, message: Any, topic: str) -> None:  # noqa: ANN401
        """Keep one message."""
        header, raw = message._connection_header, message._buff  # noqa: SLF001
        kind = get_message_class(header["type"])
        sender = header["callerid"]
        if kind is None or sender in {ME, LOG} or sender.startswith("/roslaunch"):
            return
        if topic == LOG:
            line = kind().deserialize(raw)
            if line.level >= line.ERROR and line.msg.startswith("bad callback"):
                self.complaint = self.complaint or line.msg
        else:
            self.answers += 1
            self.last_answer = time.monotonic()
            self.first_answer = self.first_answer or self.last_answer
        if self.keep and topic not in self.keep:
            return
        with self.lock:
            if self.open:
                whole = (header["type"], raw, header["md5sum"], kind)
                self.bag.write(topic, whole, self.now, raw=True)

    def close(self, outcome: dict[str, object]) -> None:
        """Finish the bag with how the run went."""
        with self.lock:
            self.bag.write(OUTCOME, String(json.dumps(outcome)), self.now)
            self.bag.close()
            self.open = False


class Player:
    """Publishes messages one by one."""

    def __init__(self, recorder: Recorder, rate: float, *, keep_going: bool) -> None:
        self.recorder = recorder
        self.rate = rate
        self.keep_going = keep_going
        self.clock = rospy.Publisher("/clock", Clock, queue_size=10)
        self.publishers: dict[str, Any] = {}
        self.pids: dict[str, int] = {}
        self.frames = 0
        self.latencies: list[float] = []
        self.began = 0.0
        self.stopped = threading.Event()
        self.reason = "the recording ended"

    def play(self, messages: Iterator[Message]) -> None:
        """Publish all messages."""
        following = next(messages, None)
        while following and not self.stopped.is_set():
            message, following = following, next(messages, None)
            stamp = message[0]
            self.publish(message, following[0] - stamp if following else 0)
        for _ in range(STEPS_AFTER):
            if not self.stopped.is_set():
                self.tick(self.recorder.now + rospy.Duration(AFTER / STEPS_AFTER))
                self.settle()

    def publish(self, message: Message, gap: int) -> None:
        """Publish one message; `gap` is the time to the next, in ns."""
        stamp, topic, kind, data = message
        message_class = get_message_class(kind)
        if topic not in self.publishers:
            self.publishers[topic] = rospy.Publisher(
                topic, message_class, queue_size=None, tcp_nodelay=True
            )
        publisher, is_picture = self.publishers[topic], kind == IMAGE
        if is_picture and not self.frames:
            self.await_subscriber(publisher, stamp)
        self.frames += is_picture
        self.tick(from_ns(stamp))
        if is_picture and not self.rate:
            self.publish_and_wait(publisher, message_class().deserialize(data), stamp, gap)
            return
        if publisher.get_num_connections():
            publisher.publish(message_class().deserialize(data))
        if is_picture:
            self.stopped.wait(max(0.0, self.began + self.frames / self.rate - time.monotonic()))

    def publish_and_wait(self, publisher: Any, picture: Any, stamp: int, gap: int) -> None:  # noqa: ANN401
        """Publish a picture and wait until it has been dealt with."""
        self.look_around()  # a node may start, or offer more, later
        answers, began = self.recorder.answers, time.monotonic()
        if publisher.get_num_connections():
            publisher.publish(picture)
        self.settle()
        if self.recorder.answers > answers:
            self.latencies.append(round(self.recorder.last_answer - began, 5))
        else:
            for step in range(1, STEPS):  # it may be asleep, by this clock
                self.tick(from_ns(stamp + gap * step // STEPS))
                self.settle()
        if self.recorder.complaint and not self.keep_going:
            self.stop("a callback raised an exception")

    def await_subscriber(self, publisher: Any, stamp: int) -> None:  # noqa: ANN401
        """Wait until somebody listens to the camera, or is there and wants to wait by the clock."""
        deadline = time.monotonic() + PATIENCE
        idle = 0
        while not (self.stopped.is_set() or publisher.get_num_connections() or idle > IDLE):
            if time.monotonic() > deadline:
                self.stop(f"no node subscribed to {publisher.resolved_name}")
            # A node may need to know the time before it subscribes.
            self.clock.publish(Clock(from_ns(stamp)))
            time.sleep(10 * TICK)
            self.look_around()
            idle = idle + 1 if self.pids and not busy(list(self.pids.values())) else 0
        self.settle()  # it may still be making its publishers
        self.look_around()  # which at a fixed rate nobody would look for again
        self.began = time.monotonic()

    def look_around(self) -> None:
        """Get to know new nodes and topics."""
        offered = MASTER.getSystemState()[0]
        for node in dict(offered).get(LOG, []):
            if node not in {ME, LOG, *self.pids} and (pid := process_of(node)):
                self.pids[node] = pid
        self.recorder.listen(offered)

    def tick(self, now: Any) -> None:  # noqa: ANN401
        """Move the clock on."""
        if now > self.recorder.now:
            self.recorder.now = now
            self.clock.publish(Clock(now))

    def settle(self) -> None:
        """Wait until nobody has anything left to do."""
        quiet, deadline = 0, time.monotonic() + PATIENCE
        while quiet < QUIET and time.monotonic() < deadline and not self.stopped.is_set():
            time.sleep(TICK)
            quiet = 0 if busy([*self.pids.values(), os.getpid()]) else quiet + 1

    def stop(self, reason: str) -> None:
        """End the playing."""
        self.reason = reason
        self.stopped.set()


def main() -> None:
    """Play what comes on the standard input; write the recording."""
    parser = argparse.ArgumentParser(description="Play messages to ROS nodes, record answers.")
    parser.add_argument("--record", required=True)
    parser.add_argument("--keep", action="append", default=[])
    parser.add_argument("--rate", type=float, default=0.0)
    parser.add_argument("--keep-going", action="store_true")
    options = parser.parse_args()
    # It asks for a queue, which is for those who must not wait. This one must.
    warnings.simplefilter("ignore", SyntaxWarning)
    rospy.init_node(ME[1:], disable_signals=True)
    recorder = Recorder(options.record, options.keep)
    player = Player(recorder, options.rate, keep_going=options.keep_going)
    signal.signal(signal.SIGINT, lambda *_: player.stop("the node ended"))
    began = time.monotonic()
    player.play(read_messages(sys.stdin.buffer))
    failed = recorder.complaint and not options.keep_going
    recorder.close(
        {
            "kind": "crashed" if failed else "ended",
            "reason": player.reason,
            "text": recorder.complaint if failed else "",
            "frames": player.frames,
            "dropped": 0,
            "latencies": player.latencies,
            "answering": round(recorder.last_answer - recorder.first_answer, 4),
            "seconds": round(time.monotonic() - began, 3),
        }
    )
    sys.stdout.flush()
    os._exit(0)  # rospy's own threads would take their time


if __name__ == "__main__":
    main()
