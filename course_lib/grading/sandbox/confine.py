"""What a process gives up before it runs a stranger's code: powers, resources, system calls."""

from __future__ import annotations

import contextlib
import ctypes
import os
import platform
import resource
import struct
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from course_lib.grading.sandbox.limits import Limits

_libc = ctypes.CDLL(None, use_errno=True)
_PR_SET_DUMPABLE, _PR_SET_SECCOMP, _PR_CAPBSET_DROP, _PR_SET_NO_NEW_PRIVS = 4, 22, 24, 38
_PR_SET_SECUREBITS, _PR_SET_CHILD_SUBREAPER = 28, 36
_NO_ROOT_BITS = 0x3F  # root's id gives no powers, and that stays so
_MOST_CAPABILITIES = 64
_CAPABILITY_VERSION_3 = 0x20080522

# x86-64 and arm64 numbers of calls that a notebook never needs and that reach deep into the kernel,
# leave the container, or hold memory that nobody counts.
_DENIED = {
    "ptrace": (101, 117),
    "process_vm_readv": (310, 270),
    "process_vm_writev": (311, 271),
    "mount": (165, 40),
    "umount2": (166, 39),
    "pivot_root": (155, 41),
    "unshare": (272, 97),
    "setns": (308, 268),
    "bpf": (321, 280),
    "perf_event_open": (298, 241),
    "keyctl": (250, 219),
    "add_key": (248, 217),
    "request_key": (249, 218),
    "io_uring_setup": (425, 425),
    "userfaultfd": (323, 282),
    "open_by_handle_at": (304, 265),
    "memfd_create": (319, 279),
    "memfd_secret": (447, 447),
    "shmget": (29, 194),
    "msgget": (68, 186),
    "semget": (64, 190),
    "fsopen": (430, 430),
    "move_mount": (429, 429),
    "open_tree": (428, 428),
    "kexec_load": (246, 104),
    "init_module": (175, 105),
    "finit_module": (313, 273),
    "clock_settime": (227, 112),
    "settimeofday": (164, 170),
    "adjtimex": (159, 171),
    "swapon": (167, 224),
    "reboot": (169, 142),
    "acct": (163, 89),
    "quotactl": (179, 60),
    "personality": (135, 92),
    "syslog": (103, 116),
    "io_setup": (206, 0),
    "kcmp": (312, 272),
    "pidfd_getfd": (438, 438),
    "process_madvise": (440, 440),
    "migrate_pages": (256, 238),
    "move_pages": (279, 239),
    "ioprio_set": (251, 30),
    "clone3": (435, 435),  # its flags cannot be looked at; libraries fall back to clone
}
# Landlock has no rule for these, which change files that the process may not even open.
_NOT_HERE = 0xFFFFFFFF
_DENIED_WITHOUT_MOUNTS = {
    "chown": (92, _NOT_HERE),
    "fchown": (93, 55),
    "lchown": (94, _NOT_HERE),
    "fchownat": (260, 54),
    "utime": (132, _NOT_HERE),
    "utimes": (235, _NOT_HERE),
    "futimesat": (261, _NOT_HERE),
    "setxattr": (188, 5),
    "lsetxattr": (189, 6),
    "fsetxattr": (190, 7),
    "removexattr": (197, 14),
    "lremovexattr": (198, 15),
    "fremovexattr": (199, 16),
    "setxattrat": (463, 463),
    "removexattrat": (466, 466),
    "file_setattr": (469, 469),
}
_MACHINES = {"x86_64": (0, 0xC000003E), "aarch64": (1, 0xC00000B7)}
# Calls that a process may make for itself or without harm: the argument that must be 0.
_FOR_ITSELF = {
    "prlimit64": ((302, 261), 0),
    "sched_setaffinity": ((203, 122), 0),
    "sched_setparam": ((142, 118), 0),
    "sched_setscheduler": ((144, 119), 1),  # the usual policy; threads of libraries ask for it
    "sched_setattr": ((314, 274), 0),
    "setpriority": ((141, 140), 0),  # of one process, not of a group or a user
    "setpriority ": ((141, 140), 1),
}
_CLONE, _SOCKET, _PAIR, _CONNECT, _MMAP = (56, 220), (41, 198), (53, 199), (42, 203), (9, 222)
_FCNTL, _SET_LEASE = (72, 25), 1024
_NEW_NAMESPACES, _ANOTHERS_CHILD = 0x7E020000, 0x8000
_AF_UNIX, _STREAM, _SEQUENCE, _TYPE = 1, 1, 5, 0x0F
# Families of which a container has a network of its own: IPv4, IPv6, netlink, which describes it.
# Others reach what is outside (vsock: a virtual machine's host), or deep into the system.
_OF_CONTAINERS = (_AF_UNIX, 2, 10, 16)
_SHARED, _ANONYMOUS, _HUGE = 1, 0x20, 0x40000
_ALLOW, _ERROR, _KILL = 0x7FFF0000, 0x00050000, 0x80000000
_ENOSYS, _EPERM, _EAFNOSUPPORT = 38, 1, 97


def bar_powers() -> None:
    """Take away what executing a program could give; needs power itself, so do it first."""
    for number in range(_MOST_CAPABILITIES):
        _libc.prctl(_PR_CAPBSET_DROP, number, 0, 0, 0)


def give_up_powers() -> None:
    """Drop every capability, now and for whatever is executed later.

    Raises
    ------
    OSError
        When the system refuses.
    """
    _libc.prctl(_PR_SET_SECUREBITS, _NO_ROOT_BITS, 0, 0, 0)
    header = struct.pack("Ii", _CAPABILITY_VERSION_3, 0)
    if _libc.capset(header, bytes(24)):
        raise OSError(ctypes.get_errno(), "cannot drop capabilities")
    if _libc.prctl(_PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0):
        raise OSError(ctypes.get_errno(), "cannot set no_new_privs")


def set_limits(limits: Limits, processes: int, pid: int = 0) -> None:
    """Limit what a process, and each that it starts, may use.

    Parameters
    ----------
    limits : Limits
    processes : int
        Most processes of its user.
    pid : int, optional
        Default: this process.
    """
    pages = int(Path(f"/proc/{pid or 'self'}/statm").read_bytes().split()[0])
    values = {
        # Addresses alone cost tables; libraries reserve far more of them than they use.
        resource.RLIMIT_AS: pages * resource.getpagesize() + 4 * limits.memory_bytes,
        resource.RLIMIT_DATA: limits.memory_bytes,
        # For each process. The watcher must come first, even late: it says why it ends them.
        resource.RLIMIT_CPU: int(limits.cpu_s) + 5,
        resource.RLIMIT_NPROC: processes,
        resource.RLIMIT_FSIZE: limits.file_bytes,
        resource.RLIMIT_NOFILE: limits.open_files,
        resource.RLIMIT_CORE: 0,
        resource.RLIMIT_MSGQUEUE: 0,
        resource.RLIMIT_MEMLOCK: 0,
    }
    for kind, value in values.items():
        _, hard = resource.prlimit(pid, kind)
        value = value if hard == resource.RLIM_INFINITY else min(value, hard)  # noqa: PLW2901
        resource.prlimit(pid, kind, (value, value))


def be_first_to_go() -> None:
    """When memory runs out, the system is to end this process and its children, not a neighbour."""
    with contextlib.suppress(OSError):
        Path("/proc/self/oom_score_adj").write_text("500", "ascii")


def become_subreaper() -> None:
    """Adopt what descendants leave behind, so that it can be found and ended."""
    _libc.prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def stay_inspectable() -> None:
    """Undo what a change of user id does: `/proc/self` would belong to root."""
    _libc.prctl(_PR_SET_DUMPABLE, 1, 0, 0, 0)


def enter(pidfd: int, *, with_user: bool) -> None:
    """Step into another process's namespaces; needs a single thread.

    Parameters
    ----------
    pidfd : int
        That process.
    with_user : bool
        Also into its user namespace.

    Raises
    ------
    OSError
        When the system refuses.
    """
    mount, network, ipc, names, pids, user = (
        0x00020000,
        0x40000000,
        0x08000000,
        0x04000000,
        0x20000000,
        0x10000000,
    )
    spaces = mount | network | ipc | names | pids | (user if with_user else 0)
    if _libc.setns(pidfd, spaces):
        error = ctypes.get_errno()
        raise OSError(error, f"cannot enter the container: {os.strerror(error)}")


def deny_calls(*, local_only: bool) -> None:
    """Refuse system calls that a notebook never needs.

    Parameters
    ----------
    local_only : bool
        Also refuse every socket that could leave the process and what it starts.

    Raises
    ------
    OSError
        When the system refuses, or for a machine whose calls are not known here.
    """
    program = denying(local_only=local_only)
    code = ctypes.create_string_buffer(program)
    filter_ = ctypes.create_string_buffer(
        struct.pack("HxxxxxxP", len(program) // 8, ctypes.addressof(code))
    )
    if _libc.prctl(_PR_SET_SECCOMP, 2, ctypes.byref(filter_), 0, 0):
        raise OSError(ctypes.get_errno(), "cannot filter system calls")


def denying(*, local_only: bool) -> bytes:
    """Give the filter of `deny_calls`, as the system takes it.

    Raises
    ------
    OSError
        For a machine whose calls are not known here.
    """
    if platform.machine() not in _MACHINES:
        raise OSError(f"no list of system calls for {platform.machine()}")
    column, architecture = _MACHINES[platform.machine()]

    def statement(code: int, value: int) -> bytes:
        return struct.pack("HBBI", code, 0, 0, value)

    def jump(code: int, value: int, yes: int, no: int) -> bytes:
        return struct.pack("HBBI", code, yes, no, value)

    def argument(number: int) -> bytes:  # its lower half
        return statement(load, 16 + 8 * number)

    def of(numbers: tuple[int, int], *checks: bytes) -> list[bytes]:
        """Do some checks for one call; whatever they load, the call's number is loaded after."""
        return [jump(equal, numbers[column], 0, len(checks) + 1), *checks, statement(load, 0)]

    load, equal, at_least, any_bit, keep, answer = 0x20, 0x15, 0x35, 0x45, 0x54, 0x06
    refuse = statement(answer, _ERROR | _EPERM)
    program = [
        statement(load, 4),
        jump(equal, architecture, 1, 0),
        statement(answer, _KILL),
        statement(load, 0),
        jump(at_least, 0x40000000, 0, 1),  # the x32 way around the numbers below
        refuse,
    ]
    for name, numbers in (_DENIED | (_DENIED_WITHOUT_MOUNTS if local_only else {})).items():
        error = _ENOSYS if name == "clone3" else _EPERM
        program += [jump(equal, numbers[column], 0, 1), statement(answer, _ERROR | error)]
    for numbers, number in _FOR_ITSELF.values():
        program += of(numbers, argument(number), jump(equal, 0, 1, 0), refuse)
    # Who is given to the parent as its child is no descendant, and would be watched by nobody.
    refused = _NEW_NAMESPACES | _ANOTHERS_CHILD
    program += of(_CLONE, argument(0), jump(any_bit, refused, 0, 1), refuse)
    # Who leases a file lets all others wait who open it; its owner may.
    program += of(_FCNTL, argument(1), jump(equal, _SET_LEASE, 0, 1), refuse)
    # Memory that is shared but in no file belongs to nobody, once its pages are let go.
    shared = [statement(keep, _ANONYMOUS | _SHARED), jump(equal, _ANONYMOUS | _SHARED, 0, 1)]
    huge = [argument(3), jump(any_bit, _HUGE, 0, 1), refuse]
    program += of(_MMAP, *huge, argument(3), *shared, refuse)
    unknown = statement(answer, _ERROR | _EAFNOSUPPORT)  # libraries know it: old machines
    if not local_only:
        ways = enumerate(_OF_CONTAINERS)
        known = [jump(equal, family, len(_OF_CONTAINERS) - place, 0) for place, family in ways]
        program += of(_SOCKET, argument(0), *known, unknown)
    if local_only:
        # Without namespaces of its own it could reach every service that listens on a path.
        local = [argument(0), jump(equal, _AF_UNIX, 1, 0), unknown]
        # What needs no connection needs no permission to connect either.
        connected = [argument(1), statement(keep, _TYPE), jump(equal, _STREAM, 2, 0)]
        connected += [jump(equal, _SEQUENCE, 1, 0), refuse]
        program += of(_SOCKET, *local, *connected)
        program += of(_PAIR, *local, *connected)
        program += of(_CONNECT, refuse)
    program.append(statement(answer, _ALLOW))
    return b"".join(program)
