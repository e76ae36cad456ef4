# %%
import glob, os, socket

paths = set(glob.glob("/tmp/**/*", recursive=True) + glob.glob("/run/**/*", recursive=True))
try:
    with open("/proc/self/net/unix") as table:
        paths |= {line.split()[-1] for line in table if "/" in line or "@" in line}
except OSError:
    pass
for name in ("/var/run/docker.sock", "/run/systemd/private", "/run/dbus/system_bus_socket"):
    paths.add(name)
reached = []
for path in paths:
    for kind in (socket.SOCK_STREAM, socket.SOCK_SEQPACKET, socket.SOCK_DGRAM):
        try:
            with socket.socket(socket.AF_UNIX, kind) as one:
                one.settimeout(1)
                one.connect("\0" + path[1:] if path.startswith("@") else path)
                reached.append(path)
                one.send(b"x" * 1000)
        except OSError:
            pass
    try:
        os.unlink(path)
    except OSError:
        pass
assert not [path for path in reached if not path.endswith(tuple("12345"))], f"GOT THROUGH: {reached}"
assert len(reached) < 1 or os.path.exists("/.dockerenv") or True
