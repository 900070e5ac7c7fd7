# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The filter of system calls of a submission's processes, a program of seccomp(2).

It refuses what neither compiler nor linker nor controller design needs and what leads around a
border: sockets, other processes, keys, memory that no limit counts, the modes and owners of files,
sessions of their own.
"""

from __future__ import annotations

import atexit
import ctypes
import errno
import functools
import shutil
import tempfile
from pathlib import Path

from ravenbrick.grading.isolation.border import IsolationError
from ravenbrick.installation import advice_for_packages

__all__ = ["filter_file"]

LIBRARY = "libseccomp.so.2"
ALLOW = 0x7FFF0000
REFUSE = 0x00050000
MASKED_EQUAL = 7
NEW_USER = 0x10000000
REFUSED = (
    "socket socketpair io_uring_setup ptrace process_vm_readv process_vm_writev pidfd_getfd "
    "pidfd_open pidfd_send_signal kill tkill tgkill rt_sigqueueinfo rt_tgsigqueueinfo setsid "
    "setpgid unshare setns mount umount2 pivot_root chroot move_mount open_tree fsopen fsmount "
    "bpf perf_event_open userfaultfd keyctl add_key request_key memfd_create memfd_secret shmget "
    "msgget semget mq_open truncate fanotify_init name_to_handle_at open_by_handle_at quotactl "
    "swapon reboot init_module finit_module kexec_load acct settimeofday clock_settime setxattr "
    "lsetxattr fsetxattr removexattr lremovexattr fremovexattr ioprio_set setpriority "
    "sched_setscheduler sched_setattr"
).split()
# The linker asks for these; that nothing happens harms nobody.
WITHOUT_EFFECT = "chmod fchmod fchmodat fchmodat2 chown fchown lchown fchownat".split()
# By the instants of files gprbuild knows what it compiled before.
INSTANTS = "utime utimes utimensat futimesat".split()


class Comparison(ctypes.Structure):
    """struct scmp_arg_cmp."""

    _fields_ = (
        ("argument", ctypes.c_uint), ("operation", ctypes.c_int),
        ("mask", ctypes.c_uint64), ("value", ctypes.c_uint64),
    )  # fmt: skip


def _refuse(
    library: ctypes.CDLL, context: ctypes.c_void_p, name: str, code: int, *compared: Comparison
) -> None:
    """A rule for a call; one that this kernel's architecture does not have needs none."""
    number = library.seccomp_syscall_resolve_name(name.encode())
    if number < 0:
        return
    array = (Comparison * len(compared))(*compared)
    action = ctypes.c_uint32(REFUSE | code)
    if library.seccomp_rule_add_array(context, action, number, len(compared), array):
        raise IsolationError(f"{LIBRARY} refuses a rule for the system call '{name}'")


@functools.cache
def filter_file(sets_instants: bool) -> Path:
    """A file with the filter, until this process ends; raises `IsolationError`.

    `sets_instants` is for a border behind which files of others cannot be written to.
    """
    try:
        library = ctypes.CDLL(LIBRARY)
    except OSError:
        advice = advice_for_packages(["libseccomp2"])
        raise IsolationError(f"{LIBRARY} is not installed; {advice}") from None
    library.seccomp_init.restype = ctypes.c_void_p
    context = ctypes.c_void_p(library.seccomp_init(ALLOW))
    for name in REFUSED:
        _refuse(library, context, name, errno.EPERM)
    for name in WITHOUT_EFFECT if sets_instants else WITHOUT_EFFECT + INSTANTS:
        _refuse(library, context, name, 0)
    # Its flags lie in memory, where no filter can look; without it the C library uses clone.
    _refuse(library, context, "clone3", errno.ENOSYS)
    new_user = Comparison(0, MASKED_EQUAL, NEW_USER, NEW_USER)
    _refuse(library, context, "clone", errno.EPERM, new_user)
    folder = Path(tempfile.mkdtemp(prefix="ravenbrick-filter-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    file = folder / "filter.bpf"
    with file.open("wb") as written:
        if library.seccomp_export_bpf(context, written.fileno()):
            raise IsolationError(f"{LIBRARY} gives no filter of system calls")
    library.seccomp_release(context)
    return file
