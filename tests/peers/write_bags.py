#!/usr/bin/env python3
"""Writes the readings of a polar CSV as bags of every kind, with the PyPI package `rosbags`, which shares no code with resect.

    write_bags.py DRIVE.csv OUT             every container, compression and state of the clocks
    write_bags.py --fixtures DRIVE.csv OUT  the first 30 readings in every container: tests/fixtures/bags
"""

import math
import sys
from decimal import Decimal
from pathlib import Path

import rosbags.rosbag1 as rosbag1
import rosbags.rosbag2 as rosbag2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

COORDS = "theodolite_node_msgs/msg/TheodoliteCoordsStamped"
CORRECTION = "theodolite_node_msgs/msg/TheodoliteTimeCorrection"
POINT = "geometry_msgs/msg/PointStamped"
DEFINITIONS = {
    COORDS: "std_msgs/Header header\nbuiltin_interfaces/Time theodolite_time\nuint8 theodolite_id\nuint8 status\n"
    "float64 azimuth\nfloat64 elevation\nfloat64 distance\n",
    CORRECTION: "std_msgs/Header header\nuint8 theodolite_id\nbuiltin_interfaces/Duration estimated_time_offset\n",
}
SECOND = 10**9
NOTHING = {1: 0, 2: 0, 3: 0}
# By how much the clocks of stations 1, 2, 3 are ahead (ns).
OFF = {1: 0, 2: 300_000_000, 3: -200_000_000}
# From the reading to the recorder (ns).
DELAY = 8_000_000
COMPRESSIONS_1 = {"plain": None, "bz2": "BZ2", "lz4": "LZ4"}
MODES_2 = {"plain": "NONE", "message": "MESSAGE", "file": "FILE", "chunk": "STORAGE"}


def store_of(ros):
    store = get_typestore(Stores.ROS1_NOETIC if ros == 1 else Stores.ROS2_HUMBLE)
    for name, definition in DEFINITIONS.items():
        if ros == 1:
            definition = definition.replace("builtin_interfaces/Time", "time").replace("builtin_interfaces/Duration", "duration")
        store.register(get_types_from_msg(definition, name))
    return store


STORES = {1: store_of(1), 2: store_of(2)}


def read(path):
    """(stamp in ns, station, range, azimuth, zenith angle) of every line."""
    lines = Path(path).read_text().splitlines()[1:]
    for line in lines:
        stamp, station, *numbers = line.split(",")
        yield int(Decimal(stamp) * SECOND), int(station), *map(float, numbers)


class Messages:
    """The messages of a drive, as (time of the recorder, topic, type, message)."""

    def __init__(self, ros, readings, header=NOTHING, own=NOTHING, corrections=False, points=False):
        self.ros, self.store = ros, STORES[ros]
        self.made = list(self.make(readings, header, own, corrections, points))

    def type(self, name):
        return self.store.types[name]

    def time(self, ns, kind="Time"):
        return self.type(f"builtin_interfaces/msg/{kind}")(sec=ns // SECOND, nanosec=ns % SECOND)

    def header(self, ns):
        seq = {"seq": 0} if self.ros == 1 else {}
        return self.type("std_msgs/msg/Header")(stamp=self.time(ns), frame_id="theodolite", **seq)

    def make(self, readings, header, own, corrections, points):
        for number, (ns, station, distance, azimuth, zenith) in enumerate(readings):
            # `None` stands for a time that nobody set.
            stamp = 0 if header is None else ns + header[station]
            own_ns = 0 if own is None else ns + own[station]
            if corrections and number % 60 < 3:
                offset = self.time(own[station], "Duration")
                message = self.type(CORRECTION)(header=self.header(stamp), theodolite_id=station, estimated_time_offset=offset)
                yield ns, "/theodolite_master/theodolite_correction_timestamp", CORRECTION, message
            if points:
                d = distance + 0.01
                point = self.type("geometry_msgs/msg/Point")(
                    x=d * math.sin(zenith) * math.cos(azimuth), y=-d * math.sin(zenith) * math.sin(azimuth), z=d * math.cos(zenith)
                )
                yield ns + DELAY, f"/station_{station}/position", POINT, self.type(POINT)(header=self.header(stamp), point=point)
                continue
            message = self.type(COORDS)(
                header=self.header(stamp),
                theodolite_time=self.time(own_ns),
                theodolite_id=station,
                status=0,
                azimuth=azimuth,
                elevation=zenith,
                distance=distance,
            )
            yield ns + DELAY, "/theodolite_master/theodolite_data", COORDS, message

    def write(self, writer, serialize):
        connections = {}
        with writer:
            for recorded, topic, name, message in self.made:
                if topic not in connections:
                    connections[topic] = writer.add_connection(topic, name, typestore=self.store)
                writer.write(connections[topic], recorded, serialize(message, name))


def ros1(path, readings, compression="plain", **kind):
    writer = rosbag1.Writer(path)
    if COMPRESSIONS_1[compression]:
        writer.set_compression(rosbag1.Writer.CompressionFormat[COMPRESSIONS_1[compression]])
    Messages(1, readings, **kind).write(writer, STORES[1].serialize_ros1)


def ros2(path, readings, container, mode="plain", **kind):
    plugin = rosbag2.StoragePlugin.MCAP if container == "mcap" else rosbag2.StoragePlugin.SQLITE3
    writer = rosbag2.Writer(path, version=9, storage_plugin=plugin)
    writer.set_compression(rosbag2.CompressionMode[MODES_2[mode]], rosbag2.CompressionFormat.ZSTD)
    Messages(2, readings, **kind).write(writer, STORES[2].serialize_cdr)


def main(arguments):
    fixtures = arguments[:1] == ["--fixtures"]
    drive, out = arguments[fixtures:]
    readings, out = list(read(drive)), Path(out)
    if fixtures:
        readings = readings[:30]
    out.mkdir(parents=True, exist_ok=True)
    for compression in COMPRESSIONS_1:
        ros1(out / f"ros1-{compression}.bag", readings, compression)
    for container in ["sqlite", "mcap"]:
        for mode in MODES_2:
            if (container, mode) != ("sqlite", "chunk"):
                ros2(out / f"{container}-{mode}", readings, container, mode)
    if fixtures:
        return
    hour = 3600 * SECOND
    for name, kind in {
        "own-off": {"own": OFF},
        "own-hour": {"own": {1: 0, 2: hour, 3: -hour}},
        "own-zero": {"own": None},
        "headers-off": {"header": OFF},
        "headers-zero": {"header": None},
        "corrections": {"own": OFF, "corrections": True},
        "points": {"points": True},
    }.items():
        ros1(out / f"{name}-1.bag", readings, **kind)
        ros2(out / f"{name}-2", readings, "mcap", **kind)
    third = len(readings) // 3
    pieces = [readings[:third], readings[third : 2 * third], readings[2 * third :]]
    (out / "split-1").mkdir()
    for number, piece in enumerate(pieces):
        ros1(out / "split-1" / f"drive_{number}.bag", piece)
        ros2(out / f"piece_{number}", piece, "sqlite")
    # rosbags does not split by itself: as `ros2 bag record` lays pieces out.
    (out / "split-2").mkdir()
    for number in range(3):
        written = out / f"piece_{number}"
        (written / f"piece_{number}.db3").rename(out / "split-2" / f"drive_{number}.db3")
        (written / "metadata.yaml").rename(out / "split-2" / "metadata.yaml")
        written.rmdir()


main(sys.argv[1:])
