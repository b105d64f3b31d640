"""Serves a recording (MCAP) by foxglove-sdk as a robot would: faster, with messages lost, repeated and out of order, and started again twice.

Usage: serve_live.py FILE.mcap [--speed N]. Prints the address, and "over" when everything was sent; then waits to be killed.
"""

import argparse
import socket
import threading
import time

import foxglove
from foxglove import Channel, Context, Schema
from foxglove.websocket import ServerListener
from mcap.reader import make_reader


class Listener(ServerListener):
    def __init__(self):
        self.subscribed = threading.Event()

    def on_subscribe(self, client, channel):
        self.subscribed.set()


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def disturbed(messages):
    """Every 17th is lost, every 11th comes again, every sixth after its neighbour, every 101st late by thirty."""
    kept = [m for k, m in enumerate(messages) if k % 17 != 16]
    for k in range(0, len(kept) - 1, 6):
        kept[k], kept[k + 1] = kept[k + 1], kept[k]
    for k in range(40, len(kept), 101):
        kept.insert(k, kept.pop(k - 30))
    return [m for k, m in enumerate(kept) for m in ([m, m] if k % 11 == 0 else [m])]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("file")
    parser.add_argument("--speed", type=float, default=20.0)
    arguments = parser.parse_args()
    with open(arguments.file, "rb") as file:
        messages = [
            (channel, schema, message.log_time, message.data)
            for schema, channel, message in make_reader(file).iter_messages()
        ]
    messages = disturbed(messages)
    port = free_port()
    print(f"ws://127.0.0.1:{port}", flush=True)
    third = len(messages) // 3
    parts = [(0, third), (third - 50, 2 * third), (2 * third - 50, len(messages))]
    for number, (begin, end) in enumerate(parts):
        listener, context = Listener(), Context()
        server = foxglove.start_server(
            name=f"robot, start {number + 1}", port=port, server_listener=listener, context=context
        )
        channels = {}
        for channel, schema, _, _ in messages[begin:end]:
            if channel.topic not in channels:
                described = Schema(name=schema.name, encoding=schema.encoding, data=schema.data)
                channels[channel.topic] = Channel(
                    channel.topic,
                    schema=described,
                    message_encoding=channel.message_encoding,
                    context=context,
                )
        listener.subscribed.wait()
        started, first = time.monotonic(), messages[begin][2]
        for channel, _, log_time, data in messages[begin:end]:
            wait = (log_time - first) * 1e-9 / arguments.speed - (time.monotonic() - started)
            if wait > 0:
                time.sleep(wait)
            channels[channel.topic].log(data, log_time=log_time)
        # What is still on its way.
        time.sleep(1.0)
        if number + 1 < len(parts):
            server.stop()
            time.sleep(0.5)
    print("over", flush=True)
    time.sleep(3600)


if __name__ == "__main__":
    main()
