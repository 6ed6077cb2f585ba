"""Checks the client against the bytes in docs/protocol.md, and against itself.

    python3 -m unittest discover clients/python
"""

import pathlib
import random
import re
import struct
import unittest

import eclss_link as e

DOCUMENT = (pathlib.Path(__file__).parents[2] / "docs" / "protocol.md").read_text(encoding="utf-8")


def documented(name: str) -> bytes:
    [shown] = re.findall(rf"^{name} +([0-9a-f ]+)$", DOCUMENT, re.M)
    return bytes.fromhex(shown)


class Bytes(unittest.TestCase):
    def test_the_documented_hello_is_what_is_sent(self):
        link = e.Link(0x1122334455667788, 42, 1000, 1, 2, nonce=7)
        self.assertEqual(link.send_tick(3, 3000, []), documented("hello"))

    def test_the_documented_data_are_read(self):
        frame = documented("data")
        self.assertEqual(frame[-1], 0)
        packet = e.read_packet(frame[:-1])
        self.assertEqual((packet.session, packet.sequence, packet.tick, packet.time_us), (0x01020304, 1, 5, 5000))
        self.assertEqual(packet.body["mode"], "RUN")
        self.assertEqual(packet.body["echo"], (9, 4000, 250))
        self.assertEqual((packet.body["values"], packet.body["quality"]), ([0.0625, -1.5], [0, 3]))

    def test_the_documented_tag_is_made(self):
        arm = e.varint(1) + e.varint(0) + e.varint(e.REQUESTS.index("arm"))
        self.assertEqual(e.command_tag(bytes(range(32)), 5, 7, 3, arm), documented("tag"))

    def test_cobs_round_trip(self):
        dice = random.Random(1)
        for length in list(range(40)) + [253, 254, 255, 256, 500, 508, 509]:
            data = bytes(dice.choice([0, 0, 1, 255, dice.randrange(256)]) for _ in range(length))
            self.assertNotIn(0, e.cobs_encode(data))
            self.assertEqual(e.cobs_decode(e.cobs_encode(data)), data)

    def test_no_flipped_bit_passes(self):
        frame = documented("data")[:-1]
        for bit in range(8 * len(frame)):
            spoiled = bytearray(frame)
            spoiled[bit // 8] ^= 1 << bit % 8
            with self.assertRaises(e.Malformed):
                e.read_packet(bytes(spoiled))


class Sessions(unittest.TestCase):
    def plant(self, nonce, echo):
        hello = e.varint(e.PLANT) + b"".join(e.varint(n) for n in (9, 42, 1000, 1, 2, nonce, echo))
        return e.to_frame(bytes([1, 0, 0, 0, 0, e.HELLO]) + hello)

    def data(self, session, sequence, value):
        body = e.varint(3) + b"\0" + bytes([0, 0, 0]) + e.varint(1) + struct.pack("<f", value) + b"\0\0"
        head = b"\1" + e.varint(session) + e.varint(sequence) + b"\0\0"
        return e.to_frame(head + e.varint(e.DATA) + body)

    def test_packets_are_taken_once_in_order_and_accounted_for(self):
        link = e.Link(9, 42, 1000, 1, 2, nonce=7)
        link.feed(self.plant(5, 7), 0)
        self.assertTrue(link.connected)
        session = link._session
        got = []
        for sequence in (1, 2, 2, 5, 4, 4, 1):
            link.feed(self.data(session, sequence, sequence), 0)
            data = link.take_data()
            got += data["values"] if data else []
        self.assertEqual(got, [1, 2, 5])
        counters = link.counters
        self.assertEqual((counters.accepted, counters.late, counters.lost, counters.duplicate), (3, 1, 1, 3))
        link.feed(self.data(session ^ 1, 6, 6), 0)
        self.assertEqual((link.take_data(), counters.foreign), (None, 1))

    def test_only_values_that_the_plant_vouches_for_are_used(self):
        link = e.Link(9, 42, 1000, 1, 2, nonce=7)
        self.assertIsNone(link.value(0))
        link.data = {"values": [1.5, 2.5, 3.5], "quality": [0, 8]}
        self.assertEqual([link.value(index) for index in range(4)], [1.5, None, 3.5, None])

    def test_a_plant_that_started_anew_with_the_same_number_gets_no_answer(self):
        link = e.Link(9, 42, 1000, 1, 2, nonce=7)
        link.feed(self.plant(5, 7), 0)
        link.send_tick(0, 0, [])
        link.feed(self.plant(5, 0), 0)
        self.assertEqual(self.hellos(link.send_tick(1, 1000, [])), 1, "it may not have heard of us yet")
        link.feed(self.data(link._session, 1, 1.0), 0)
        link.feed(self.plant(5, 0), 0)
        self.assertEqual(self.hellos(link.send_tick(2, 2000, [])), 0)

    def hellos(self, sent):
        packets = [e.read_packet(frame) for frame in sent.split(b"\0") if frame]
        return sum(packet.kind == e.HELLO for packet in packets)

    def test_a_client_that_only_answers_tells_the_plant_its_number(self):
        link = e.Link(9, 42, 1000, 1, 2, nonce=7)
        link.feed(self.plant(5, 7), 0)
        self.assertTrue(link.connected)
        self.assertEqual(link.send_tick(0, 0, None), b"", "nothing has been asked")
        link.feed(self.plant(5, 7), 0)
        [frame] = [frame for frame in link.send_tick(1, 1000, None).split(b"\0") if frame]
        self.assertEqual((e.read_packet(frame).kind, e.read_packet(frame).body["echo"]), (e.HELLO, 5))

    def test_a_client_with_a_key_signs_each_packet_of_a_command(self):
        link = e.Link(9, 42, 1000, 1, 2, nonce=7, key=bytes(range(32)), resend_ticks=2)
        link.feed(self.plant(5, 7), 0)
        self.assertTrue(link.command("arm"))
        packets = [e.read_packet(link.send_tick(tick, 0, None).strip(b"\0") or documented("data")[:-1]) for tick in range(4)]
        keyed = [packet for packet in packets if packet.kind == e.KEYED]
        self.assertEqual([packet.sequence for packet in keyed], [1, 2])
        arm = e.varint(1) + e.varint(0) + e.varint(0)
        for packet in keyed:
            self.assertEqual(packet.body["args"], ["arm"])
            self.assertEqual(packet.body["tag"], e.command_tag(bytes(range(32)), 5, 7, packet.sequence, arm))

    def test_another_network_is_refused_by_name(self):
        link = e.Link(10, 42, 1000, 1, 2, nonce=7)
        link.feed(self.plant(5, 7), 0)
        packets = [e.read_packet(frame) for frame in link.send_tick(1, 1000, []).split(b"\0") if frame]
        refused = [packet.body for packet in packets if packet.kind == e.REFUSED]
        self.assertEqual(refused, [{"reason": "network", "echo": 5}])

    def test_another_network_is_refused_and_silence_ends_a_session(self):
        link = e.Link(10, 42, 1000, 1, 2, nonce=7)
        link.feed(self.plant(5, 7), 0)
        self.assertFalse(link.connected)
        link = e.Link(9, 42, 1000, 1, 2, nonce=7)
        link.feed(self.plant(5, 7), 0)
        for tick in range(201):
            link.send_tick(tick, 1000 * tick, [])
        self.assertFalse(link.connected)
        self.assertEqual(link.nonce, 8)


if __name__ == "__main__":
    unittest.main()
