"""A live host: reads frames of counts from a serial line and prints where it is, once a second.

    python examples/live_serial.py                  # a simulated sensor on a pair of sockets
    python examples/live_serial.py /dev/ttyUSB0     # a real line, set up by stty before

A frame has 31 bytes, integers little-endian:

    byte    0 1    2 3        4        5 to 16               17 to 28               29 30
            A5 5A  counter    fault    gyro x, y, z int32    accel x, y, z int32    CRC

`counter` goes up by one with each frame and wraps at 2^16; `fault` is 0 or 1; the CRC is
CRC-16/CCITT-FALSE (polynomial 1021h, first value FFFFh) over bytes 2 to 28.  A frame whose CRC is
wrong is passed over: the counter then shows that samples are missing, and the navigator coasts.
"""

from __future__ import annotations

import os
import socket
import struct
import sys
import threading
from binascii import crc_hqx
from collections.abc import Iterator

import numpy as np

import sculler

SYNC = b"\xa5\x5a"
BODY = struct.Struct("<HB6i")
SIZE = len(SYNC) + BODY.size + 2
PLACE = {"lat": 48.0, "lon": 11.0, "height": 500.0}
SPEED, SECONDS = 30.0, 5.1  # of the simulated motion, m/s and s


def frame(counter: int, fault: int, counts: list[int]) -> bytes:
    """One sample as the sensor sends it."""
    body = BODY.pack(counter & 0xFFFF, fault, *counts)
    return SYNC + body + struct.pack("<H", crc_hqx(body, 0xFFFF))


def bodies(stream: Iterator[bytes]) -> Iterator[list[bytes]]:
    """The good frames' bodies, those of each burst of bytes together."""
    buffer = b""
    for burst in stream:
        buffer += burst
        good = []
        while (at := buffer.find(SYNC)) >= 0 and len(buffer) - at >= SIZE:
            body, crc = buffer[at + 2 : at + SIZE - 2], buffer[at + SIZE - 2 : at + SIZE]
            right = struct.unpack("<H", crc)[0] == crc_hqx(body, 0xFFFF)
            if right:
                good.append(body)
            buffer = buffer[at + (SIZE if right else 1) :]  # a wrong one may hide a true beginning
        yield good


def read(file: int) -> Iterator[bytes]:
    """What comes from an open line, until it closes."""
    while True:
        burst = os.read(file, 4096)
        if not burst:
            return
        yield burst


def send(design: sculler.Design, wire: socket.socket) -> None:
    """The simulated sensor: a coordinated turn; one frame after 3 s is damaged on the way."""
    motion = sculler.motion("turn", **PLACE, speed=SPEED)
    log = sculler.record(design, motion, SECONDS)
    damaged = round(3.0055 * design.sensor.sample_rate_hz)
    for number, counts in enumerate(log.counts.tolist()):
        # the counter of a sensor that was on for a while wraps soon
        data = bytearray(frame(65_000 + number, 0, counts))
        if number == damaged:
            data[10] ^= 0x40
        wire.sendall(data)
    wire.close()


def main() -> None:
    """Navigate until the line closes."""
    design = sculler.Design.preset("stim300")
    if len(sys.argv) > 1:
        line = os.open(sys.argv[1], os.O_RDONLY | os.O_NOCTTY)
    else:
        far, near = socket.socketpair()
        line = near.detach()
        threading.Thread(target=send, args=(design, far), daemon=True).start()
    begin = sculler.motion("turn", **PLACE, speed=SPEED).state(np.zeros(1)).state(0)
    roll, pitch, heading = np.degrees(begin.euler).tolist()
    north, east, down = begin.v
    live = sculler.LiveNavigator(
        design,
        sequence_bits=16,
        **PLACE,
        roll=roll,
        pitch=pitch,
        heading=heading,
        vn=north,
        ve=east,
        vd=down,
    )
    second = 0
    for burst in bodies(read(line)):
        rows = [BODY.unpack(body) for body in burst]
        if not rows:
            continue
        table = np.array(rows)
        states = live.feed(table[:, 2:8], faults=table[:, 1], sequence=table[:, 0])
        for row in range(len(states)):
            state = states.state(row)
            if state.time > second - 1e-6:
                lat, lon, heading = np.degrees([state.lat, state.lon, state.euler[2]]).tolist()
                print(
                    f"{state.time:6.2f} s  lat {lat:.6f}°  lon {lon:.6f}°  height {state.h:.2f} m"
                    f"  heading {heading:.3f}°",
                    flush=True,
                )
                second += 1
    for warning in live.warnings:
        print("warning:", warning)


if __name__ == "__main__":
    main()
