#!/usr/bin/env python3
"""Holds the flow of networks/hil.toml by its valve: a PI controller at the other end of the link.

    python3 clients/python/hold_flow.py --network-id 0x… --process-id 0x… unix:eclss.sock

Ids are told by the plant's log and by `eclss-rt check`. Addresses: `unix:PATH`, `tcp:HOST:PORT`, `udp:HOST:PORT`.
"""

import argparse
import json
import os
import select
import socket
import sys
import time

from eclss_link import Link


AT_MOST_UNDER_WAY = 4
# Longest time that one sample stands for [s]: an error that was not measured is not integrated.
LONGEST_SAMPLE_S = 0.02


def connect(address: str) -> socket.socket:
    kind, _, where = address.partition(":")
    if kind == "unix":
        end = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        target = where
    else:
        host, _, port = where.rpartition(":")
        end = socket.socket(socket.AF_INET, socket.SOCK_DGRAM if kind == "udp" else socket.SOCK_STREAM)
        target = (host, int(port))
    deadline = time.monotonic() + 10
    while True:
        try:
            end.connect(target)
            end.setblocking(False)
            return end
        except (FileNotFoundError, ConnectionRefusedError):
            if time.monotonic() > deadline:
                raise
            time.sleep(0.05)


def main() -> int:
    number = lambda text: int(text, 0)
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("address")
    parser.add_argument("--network-id", type=number, required=True)
    parser.add_argument("--process-id", type=number, required=True)
    parser.add_argument("--step-us", type=int, default=1000)
    parser.add_argument("--set-point", type=float, default=0.06, help="flow [kg/s]")
    parser.add_argument("--seconds", type=float, default=60.0, help="time in RUN")
    parser.add_argument("--key", type=lambda path: bytes.fromhex(open(path).read()), help="file with 64 hexadecimal digits")
    args = parser.parse_args()
    end = connect(args.address)
    nonce = int.from_bytes(os.urandom(4), "little")
    link = Link(args.network_id, args.process_id, args.step_us, inputs=2, outputs=2, nonce=nonce, key=args.key)
    step_s = args.step_us * 1e-6
    opening = total = 0.2
    # Gains for a flow that follows within seconds, and a rate that the valve's channel believes.
    kp, ki, rate_per_s = 4.0, 6.0, 3.0
    begun = time.monotonic()
    mode, modes, flow = "", [], 0.0
    tick, run_ticks, first_run, last, next_request = 0, 0, None, 0, 0
    backlog = bytearray()
    while run_ticks * step_s < args.seconds and not (link.refused and tick > 100):
        # The plant is time master: its data set the pace, and a clock only while there are none.
        select.select([end], [end] if backlog else [], [], 0.02)
        now_us = int((time.monotonic() - begun) * 1e6)
        try:
            got = end.recv(65536)
            if not got:
                break
            link.feed(got, now_us)
        except (BlockingIOError, ConnectionRefusedError):
            pass
        except ConnectionResetError:
            break
        data = link.take_data()
        if data:
            if data["mode"] != mode:
                mode = data["mode"]
                modes.append(mode)
                last = link.tick
            # A value whose quality is not good is no measurement: the valve stays where it is.
            measured = link.value(0)
            flow = flow if measured is None else measured
            if mode == "RUN":
                first_run = link.tick if first_run is None else first_run
                run_ticks = link.tick - first_run
            if mode == "RUN" and measured is not None:
                error, passed_s = args.set_point - flow, min((link.tick - last) * step_s, LONGEST_SAMPLE_S)
                total = min(max(total + ki * error * passed_s, 0.02), 1.0)
                most = rate_per_s * passed_s
                wanted = min(max(total + kp * error, opening - most), opening + most)
                opening = min(max(wanted, 0.02), 1.0)
            last = link.tick
        tick += 1
        # Frames sent faster than the plant takes them only grow old in a queue.
        room = not link.connected or (link.under_way <= AT_MOST_UNDER_WAY and not backlog)
        # A plant that cannot be trusted has to start anew; any other only wants to be acknowledged.
        untrusted = link.ack is not None and link.ack.get("value") == "plant"
        request = {"READY": "arm", "SAFE": "restart" if untrusted else "acknowledge"}.get(mode)
        if room and request and tick >= next_request and link.command(request):
            next_request = tick + 50
        backlog += link.send_tick(tick, now_us, [opening, 1.0] if room else None)
        try:
            del backlog[: end.send(backlog)]
        except BlockingIOError:
            pass
        except (BrokenPipeError, ConnectionResetError, ConnectionRefusedError):
            break
    counters = vars(link.counters)
    print(json.dumps({"mode": mode, "modes": modes, "run_ticks": run_ticks, "plant_tick": link.tick, "flow_kg_s": flow,
                      "opening": opening, "refused": link.refused, "sent": link.sent, **counters}))
    return 0 if mode == "RUN" else 1


if __name__ == "__main__":
    sys.exit(main())
