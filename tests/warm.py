"""`sculler` without its start: a process that has imported everything forks for every command.

A command gets what a process of its own would have: arguments, folder, environment, the three
standard streams, its exit status.  What is about processes themselves (start-up, signals,
encodings, closed streams) is tested with real ones.
"""

from __future__ import annotations

import json
import os
import select
import socket
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from pkgutil import walk_packages

_LENGTH, _STATUS = 8, 1  # bytes

_CLIENT = """
import _socket, array, json, os, sys
to = _socket.socket(_socket.AF_UNIX, _socket.SOCK_STREAM)
to.connect({address!r})
command = json.dumps([sys.argv[1:], os.getcwd(), dict(os.environ)]).encode()
streams = array.array("i", [0, 1, 2])
to.sendmsg([len(command).to_bytes({length}, "big")],
           [(_socket.SOL_SOCKET, _socket.SCM_RIGHTS, streams)])
to.sendall(command)
os._exit((to.recv({status}) or b"F")[0])
"""
"""What stands for `sculler` on the path: ten milliseconds."""


@contextmanager
def warm(environment: Mapping[str, str], before: str = "") -> Iterator[Path]:
    """Start the process; gives the file to run in place of `sculler`; ends the process.

    Args:
        environment: to start it in.
        before: Python to execute before anything is imported.
    """
    with tempfile.TemporaryDirectory(prefix="warm-") as name:  # a socket's path must be short
        program, client, address = (
            Path(name) / file for file in ("sculler", "client.py", "socket")
        )
        client.write_text(_CLIENT.format(address=str(address), length=_LENGTH, status=_STATUS))
        program.write_text(f'#!/bin/sh\nexec "{sys.executable}" -SI "{client}" "$@"\n')
        program.chmod(0o755)
        process = subprocess.Popen(
            [sys.executable, __file__, address, before],
            env={**environment, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
            stdin=subprocess.PIPE,  # it ends when we do
        )
        try:
            while not address.exists():
                assert process.poll() is None
                time.sleep(0.01)
            yield program
        finally:
            process.communicate()


def _import(packages: Iterable[str]) -> None:
    for package in packages:
        module = import_module(package)
        for found in walk_packages(module.__path__, f"{package}."):
            if not found.name.endswith(("__main__", "apart_child")):
                with suppress(ModuleNotFoundError):  # a module that needs an extra
                    import_module(found.name)


def _serve(address: str) -> None:
    import_module("sculler.main")
    _import(("sculler", "sculler_sim", "sculler_hdl", "sculler_model"))
    with suppress(ImportError):
        import_module("matplotlib.backends.backend_agg")
        import_module("matplotlib.figure")
    with suppress(ImportError):
        import_module("numba.extending")
    listener = socket.socket(socket.AF_UNIX)
    listener.bind(f"{address}.new")
    listener.listen()
    Path(f"{address}.new").rename(address)
    while listener in select.select([listener, 0], [], [])[0]:
        connection, _ = listener.accept()
        if os.fork() == 0:
            listener.close()
            _run(connection)
        connection.close()
        with suppress(ChildProcessError):
            while os.waitpid(-1, os.WNOHANG)[0]:
                pass


def _run(connection: socket.socket) -> None:
    """In the child: a command, never to return."""
    status = 70
    try:
        head, streams, *_ = socket.recv_fds(connection, _LENGTH, 3)
        with connection.makefile("rb") as rest:
            words, folder, environment = json.loads(rest.read(int.from_bytes(head, "big")))
        for number, stream in enumerate(streams):
            os.dup2(stream, number)
            os.close(stream)
        os.environ.clear()
        os.environ.update(environment)
        os.chdir(folder)
        sys.stdin, sys.stdout, sys.stderr = (
            os.fdopen(number, mode, encoding="utf-8", closefd=False)
            for number, mode in enumerate(("r", "w", "w"))
        )
        sys.argv = ["sculler", *words]
        from sculler.main import main

        status = main()
        sys.stdout.flush()
        sys.stderr.flush()
    except BaseException:
        traceback.print_exc()
        sys.stderr.flush()
    finally:
        connection.sendall(bytes([status]))
        os._exit(status)


if __name__ == "__main__":
    exec(sys.argv[2], {})
    _serve(sys.argv[1])
