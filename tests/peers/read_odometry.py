#!/usr/bin/env python3
"""Prints the odometry of a bag as TUM, each line with the variance of x, the speed ahead and its variance, by programs that share no code with resect.

    read_odometry.py FILE.bag     with the PyPI package rosbags
    read_odometry.py FILE.mcap    with the PyPI package mcap-ros2-support
"""

import sys
from pathlib import Path


def messages(path):
    """(stamp of the container in ns, message), in order of time."""
    if path.suffix == ".mcap":
        from mcap_ros2.reader import read_ros2_messages

        for read in read_ros2_messages(path, topics=["/resect/odometry"]):
            assert read.schema.name == "nav_msgs/msg/Odometry"
            yield read.log_time_ns, read.ros_msg
    else:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore

        with AnyReader([path]) as reader:
            (connection,) = reader.connections
            _, md5 = get_typestore(Stores.ROS1_NOETIC).generate_msgdef("nav_msgs/msg/Odometry")
            assert connection.digest == md5, "the definition is not ROS's"
            for _, time_ns, raw in reader.messages():
                yield time_ns, reader.deserialize(raw, connection.msgtype)


for time_ns, message in messages(Path(sys.argv[1])):
    stamp = message.header.stamp
    nanosec = stamp.nanosec
    assert time_ns == stamp.sec * 10**9 + nanosec
    assert message.header.frame_id == "station1" and message.child_frame_id == "vehicle"
    p, q = message.pose.pose.position, message.pose.pose.orientation
    twist = message.twist
    numbers = [p.x, p.y, p.z, q.x, q.y, q.z, q.w, message.pose.covariance[0], twist.twist.linear.x, twist.covariance[0]]
    print(f"{stamp.sec}.{nanosec:09d}", *numbers)
