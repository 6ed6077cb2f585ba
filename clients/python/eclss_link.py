"""The link protocol of eclss-rt, version 1, in plain Python: see docs/protocol.md.

`Link` takes bytes (`feed`) and gives bytes (`send_tick`), and has no input or output of its own, like the one in Rust.
Only the standard library is used.
"""

import hashlib
import hmac
import struct
import zlib
from dataclasses import dataclass, field

VERSION = 1
FRAME_BYTES = 512
PLANT, CONTROLLER = 0, 1
MODES = ("POWERUP", "INIT", "READY", "RUN", "HOLD", "SAFE")
REQUESTS = ("arm", "hold", "resume", "disarm", "acknowledge", "restart", "stop", "settle")
REFUSALS = ("role", "network", "process", "step")
OUTCOMES = ("mode", "value", "refused", "no such parameter", "out of range", "busy")
# Qualities of values that are meant: good, limited, on their way. Everything else stands in for something.
MEANT = (0, 3, 9)
HELLO, REFUSED, DATA, COMMAND, ACK, KEYED = range(6)
TAG_BYTES = 16


def command_tag(key: bytes, plant_nonce: int, controller_nonce: int, sequence: int, command: bytes) -> bytes:
    """The proof that a command's sender has the key; `command` is the command as it is sent."""
    signed = b"eclss-rt command 1" + struct.pack("<III", plant_nonce, controller_nonce, sequence) + command
    return hmac.new(key, signed, hashlib.sha256).digest()[:TAG_BYTES]


class Malformed(ValueError):
    """Bytes that are no packet."""


# --- frames -----------------------------------------------------------------------------------------------------


def cobs_encode(data: bytes) -> bytes:
    """COBS without the zero at the end."""
    out, block = bytearray(), bytearray()
    for byte in data:
        if byte == 0:
            out.append(len(block) + 1)
            out += block
            block.clear()
            continue
        block.append(byte)
        if len(block) == 254:
            out.append(255)
            out += block
            block.clear()
    out.append(len(block) + 1)
    return bytes(out + block)


def cobs_decode(frame: bytes) -> bytes:
    """The data of a frame without its zero."""
    out, at = bytearray(), 0
    while at < len(frame):
        code = frame[at]
        if code == 0 or at + code > len(frame):
            raise Malformed("no COBS")
        out += frame[at + 1 : at + code]
        at += code
        if code != 255 and at < len(frame):
            out.append(0)
    return bytes(out)


def to_frame(packet: bytes) -> bytes:
    """A packet with its check sum, ready for the wire."""
    return cobs_encode(packet + struct.pack("<I", zlib.crc32(packet))) + b"\0"


# --- postcard ---------------------------------------------------------------------------------------------------


def varint(number: int) -> bytes:
    out = bytearray()
    while number > 127:
        out.append(number & 127 | 128)
        number >>= 7
    out.append(number)
    return bytes(out)


class Reader:
    """Reads postcard: one field after the other."""

    def __init__(self, data: bytes):
        self.data, self.at = data, 0

    def byte(self) -> int:
        if self.at >= len(self.data):
            raise Malformed("too short")
        self.at += 1
        return self.data[self.at - 1]

    def varint(self, bits: int) -> int:
        number = shift = 0
        while True:
            byte = self.byte()
            number |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                if number >> bits:
                    raise Malformed("number too large")
                return number
            if shift >= bits:
                raise Malformed("number too long")

    def choice(self, words: tuple) -> int:
        number = self.varint(32)
        if number >= len(words):
            raise Malformed("no such variant")
        return number

    def f32(self) -> float:
        if self.at + 4 > len(self.data):
            raise Malformed("too short")
        self.at += 4
        return struct.unpack("<f", self.data[self.at - 4 : self.at])[0]

    def list(self, item) -> list:
        length = self.varint(32)
        if length > 64:
            raise Malformed("list too long")
        return [item() for _ in range(length)]

    def end(self):
        if self.at != len(self.data):
            raise Malformed("something behind the packet")


@dataclass
class Packet:
    session: int
    sequence: int
    tick: int
    time_us: int
    kind: int
    body: dict


def read_packet(frame: bytes) -> Packet:
    """A packet out of a frame without its zero; `Malformed` where it is none."""
    data = cobs_decode(frame)
    if len(data) < 10:
        raise Malformed("truncated")
    packet, check = data[:-4], struct.unpack("<I", data[-4:])[0]
    if zlib.crc32(packet) != check:
        raise Malformed("check sum")
    r = Reader(packet)
    if r.byte() != VERSION:
        raise Malformed("version")
    session, sequence, tick, time_us = r.varint(32), r.varint(32), r.varint(64), r.varint(64)
    kind = r.choice(("hello", "refused", "data", "command", "ack", "keyed"))
    if kind == HELLO:
        names = ("role", "network_id", "process_id", "step_us", "inputs", "outputs", "nonce", "echo")
        body = dict(zip(names, [r.choice(("plant", "controller"))] + [r.varint(n) for n in (64, 64, 32, 16, 16, 32, 32)]))
    elif kind == REFUSED:
        body = {"reason": REFUSALS[r.choice(REFUSALS)], "echo": r.varint(32)}
    elif kind == DATA:
        body = {"mode": MODES[r.choice(MODES)], "cause": r.byte()}
        body["echo"] = (r.varint(32), r.varint(64), r.varint(32))
        body["values"], body["quality"], body["seen"] = r.list(r.f32), r.list(r.byte), r.list(r.byte)
    elif kind in (COMMAND, KEYED):
        body = {"id": r.varint(32), "command": r.choice(("mode", "set", "get"))}
        body["args"] = (
            [REQUESTS[r.choice(REQUESTS)]]
            if body["command"] == 0
            else [r.varint(16), r.f32()] if body["command"] == 1 else [r.varint(16)]
        )
        if kind == KEYED:
            body["tag"] = bytes(r.byte() for _ in range(TAG_BYTES))
    else:
        body = {"id": r.varint(32), "outcome": OUTCOMES[r.choice(OUTCOMES)]}
        if body["outcome"] == "mode":
            body["value"] = MODES[r.choice(MODES)]
        elif body["outcome"] == "value":
            body["value"] = r.f32()
        elif body["outcome"] == "refused":
            reasons = ("mode", "plant", "inputs", "outputs", "key")
            body["value"] = reasons[r.choice(reasons)]
    r.end()
    return Packet(session, sequence, tick, time_us, kind, body)


# --- the link ---------------------------------------------------------------------------------------------------


@dataclass
class Counters:
    accepted: int = 0
    duplicate: int = 0
    late: int = 0
    lost: int = 0
    handshake: int = 0
    damaged: int = 0
    foreign: int = 0
    sessions: int = 0


@dataclass
class Link:
    """The controller's end."""

    network_id: int
    process_id: int
    step_us: int
    inputs: int
    outputs: int
    nonce: int
    key: bytes = None
    hello_ticks: int = 20
    silent_ticks: int = 200
    resend_ticks: int = 20
    counters: Counters = field(default_factory=Counters)
    refused: str = ""
    data: dict = None
    tick: int = 0

    def __post_init__(self):
        self.nonce = self.nonce & 0xFFFFFFFF or 1
        self._buffer, self._oversize = bytearray(), False
        self._peer = self._session = None
        self._newest, self._came = 0, set()
        self._sequence = self._quiet = self._until_hello = 0
        self._answer, self._refuse = False, None
        self._echo, self._told, self._arrived_us = (0, 0), 0, 0
        self._command, self._wait, self._next_id = None, 0, 0
        self.ack = None
        self._fresh = False

    @property
    def connected(self) -> bool:
        return self._session is not None

    @property
    def commanding(self) -> bool:
        return self._command is not None

    @property
    def sent(self) -> int:
        return self._sequence

    @property
    def under_way(self) -> int:
        """Packets of this session that the peer has not said to have got."""
        return (self._sequence - self._told) & 0xFFFFFFFF

    def feed(self, data: bytes, now_us: int):
        """Takes bytes that came in."""
        for byte in data:
            if byte:
                self._oversize |= len(self._buffer) + 1 >= FRAME_BYTES
                if not self._oversize:
                    self._buffer.append(byte)
                continue
            frame, oversize = bytes(self._buffer), self._oversize
            self._buffer.clear()
            self._oversize = False
            if not frame and not oversize:
                continue
            try:
                if oversize:
                    raise Malformed("oversize")
                self._take(read_packet(frame), now_us)
            except Malformed:
                self.counters.damaged += 1

    def take_data(self):
        """The newest process data since the last call, or None."""
        fresh, self._fresh = self._fresh, False
        return self.data if fresh else None

    def value(self, index: int):
        """Value `index` of the newest data; None where there is none or the plant does not vouch for it."""
        values, quality = (self.data["values"], self.data["quality"]) if self.data else ((), ())
        if index >= len(values) or (index < len(quality) and quality[index] not in MEANT):
            return None
        return values[index]

    def command(self, *words) -> bool:
        """`command("arm")`, `command("set", 3, 0.5)`, `command("get", 3)`; False while another is on its way."""
        if self._command is not None or self._session is None:
            return False
        self._next_id += 1
        if words[0] == "set":
            body = varint(1) + varint(words[1]) + struct.pack("<f", words[2])
        elif words[0] == "get":
            body = varint(2) + varint(words[1])
        else:
            body = varint(0) + varint(REQUESTS.index(words[0]))
        self._command, self._wait, self.ack = varint(self._next_id) + body, 0, None
        return True

    def send_tick(self, tick: int, now_us: int, values) -> bytes:
        """Ends a tick; returns the bytes to send in it. Without `values` (None) there are no process data in it."""
        self._quiet += 1
        if self._session is not None and self._quiet > self.silent_ticks:
            self._session = self._peer = self._command = None
            self.nonce = (self.nonce + 1) & 0xFFFFFFFF or 1
            self._until_hello = 0
        out = b""
        if self._refuse is not None:
            reason, nonce = self._refuse
            self._refuse = None
            out += self._packet(0, 0, tick, now_us, REFUSED, varint(REFUSALS.index(reason)) + varint(nonce))
        due = self._session is None and self._until_hello == 0
        self._until_hello = self.hello_ticks if due else max(self._until_hello - 1, 0)
        if due or self._answer:
            self._answer = False
            hello = varint(CONTROLLER) + varint(self.network_id) + varint(self.process_id)
            for number in (self.step_us, self.inputs, self.outputs, self.nonce, self._peer or 0):
                hello += varint(number)
            out += self._packet(0, 0, tick, now_us, HELLO, hello)
        if self._session is None:
            return out
        if self._command is not None:
            if self._wait == 0:
                kind, body = COMMAND, self._command
                if self.key is not None:
                    nonces = (self._peer, self.nonce)
                    kind, body = KEYED, body + command_tag(self.key, *nonces, self._sequence + 1 & 0xFFFFFFFF, body)
                out += self._next(tick, now_us, kind, body)
                self._wait = self.resend_ticks
            self._wait -= 1
        if values is None:
            return out
        age = min(max(now_us - self._arrived_us, 0), 0xFFFFFFFF)
        body = varint(MODES.index("RUN")) + b"\0" + varint(self._echo[0]) + varint(self._echo[1]) + varint(age)
        body += varint(len(values)) + struct.pack(f"<{len(values)}f", *values) + varint(0) + varint(0)
        return out + self._next(tick, now_us, DATA, body)

    def _packet(self, session, sequence, tick, now_us, kind, body) -> bytes:
        head = bytes([VERSION]) + varint(session) + varint(sequence) + varint(tick) + varint(now_us)
        return to_frame(head + varint(kind) + body)

    def _next(self, tick, now_us, kind, body) -> bytes:
        self._sequence = (self._sequence + 1) & 0xFFFFFFFF
        return self._packet(self._session, self._sequence, tick, now_us, kind, body)

    def _session_with(self, peer: int) -> int:
        return zlib.crc32(struct.pack("<II", peer, self.nonce)) or 1

    def _begin(self, session: int):
        self._session, self._newest, self._came = session, 0, set()
        self._sequence = self._quiet = 0
        self._echo, self._told, self.refused = (0, 0), 0, ""
        self.counters.sessions += 1

    def _take(self, packet: Packet, now_us: int):
        if packet.kind == HELLO and packet.session == 0:
            self._hello(packet.body)
        elif packet.kind == REFUSED and packet.session == 0:
            self.counters.handshake += 1
            if self._session is None and packet.body["echo"] == self.nonce:
                self.refused = packet.body["reason"]
        elif packet.kind in (DATA, COMMAND, ACK, KEYED) and self._belongs(packet.session):
            self._sequenced(packet, now_us)
        else:
            self.counters.foreign += 1

    def _hello(self, hello: dict):
        pairs = (
            ("role", hello["role"] == PLANT),
            ("network", hello["network_id"] == self.network_id),
            ("process", all(hello[k] == getattr(self, k) for k in ("process_id", "inputs", "outputs"))),
            ("step", hello["step_us"] == self.step_us),
        )
        wrong = [reason for reason, agrees in pairs if not agrees]
        if wrong:
            self.counters.foreign += 1
            self._refuse = (wrong[0], hello["nonce"])
            return
        self.counters.handshake += 1
        if self._session is not None:
            # It may not know our number yet. One that has spoken in this session started anew with the same number.
            self._answer = self._peer == hello["nonce"] and not self._newest
            return
        self._peer = hello["nonce"]
        if hello["echo"] == self.nonce:
            self._begin(self._session_with(self._peer))
        else:
            self._answer = True

    def _belongs(self, session: int) -> bool:
        if self._session is None and self._peer is not None and self._session_with(self._peer) == session:
            self._begin(session)
        return self._session == session

    def _sequenced(self, packet: Packet, now_us: int):
        ahead = (packet.sequence - self._newest) & 0xFFFFFFFF
        if 0 < ahead < 1 << 31:
            self.counters.lost += ahead - 1
            self._newest = packet.sequence
            self._came = {n for n in self._came if (packet.sequence - n) & 0xFFFFFFFF < 64} | {packet.sequence}
        elif packet.sequence in self._came:
            self.counters.duplicate += 1
            return
        else:
            self.counters.late += 1
            if (self._newest - packet.sequence) & 0xFFFFFFFF < 64:
                self.counters.lost -= 1
                self._came.add(packet.sequence)
            return
        self.counters.accepted += 1
        self._quiet = 0
        self._echo, self._arrived_us = (packet.sequence, packet.time_us), now_us
        if packet.kind == DATA:
            self.data, self.tick, self._fresh = packet.body, packet.tick, True
            self._told = packet.body["echo"][0]
        elif packet.kind == ACK and self._command is not None and packet.body["id"] == self._next_id:
            self._command, self.ack = None, packet.body
