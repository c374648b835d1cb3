"""Reads an MCAP file with the packages mcap and rosbags, and compares its messages with what was written.

usage: read_recording.py FILE.mcap EXPECTED.json
The JSON holds by topic {"hash": ..., "message": {...}}, with floating-point numbers in hexadecimal.
"""
import json
import sys
from pathlib import Path

from mcap.reader import make_reader
from mcap.records import Chunk, Message
from mcap.stream_reader import StreamReader, breakup_chunk
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

# Of packages that rosbags does not know, as their repositories have them: ros-event-camera/event_camera_msgs,
# Livox-SDK/livox_ros_driver2, ros-perception/vision_msgs (branch ros2).
FOREIGN_TYPES = {
    "event_camera_msgs/msg/EventPacket": """
std_msgs/Header header
uint32 height
uint32 width
uint64 seq
uint64 time_base
string encoding
bool is_bigendian
uint8[] events
""",
    "livox_ros_driver2/msg/CustomPoint": """
uint32 offset_time
float32 x
float32 y
float32 z
uint8 reflectivity
uint8 tag
uint8 line
""",
    "livox_ros_driver2/msg/CustomMsg": """
std_msgs/Header header
uint64 timebase
uint32 point_num
uint8 lidar_id
uint8[3] rsvd
CustomPoint[] points
""",
    "vision_msgs/msg/Point2D": "float64 x\nfloat64 y",
    "vision_msgs/msg/Pose2D": "vision_msgs/Point2D position\nfloat64 theta",
    "vision_msgs/msg/BoundingBox2D": "vision_msgs/Pose2D center\nfloat64 size_x\nfloat64 size_y",
    "vision_msgs/msg/BoundingBox3D": "geometry_msgs/Pose center\ngeometry_msgs/Vector3 size",
    "vision_msgs/msg/ObjectHypothesis": "string class_id\nfloat64 score",
    "vision_msgs/msg/ObjectHypothesisWithPose": "ObjectHypothesis hypothesis\ngeometry_msgs/PoseWithCovariance pose",
    "vision_msgs/msg/Detection2D": """
std_msgs/Header header
ObjectHypothesisWithPose[] results
BoundingBox2D bbox
string id
""",
    "vision_msgs/msg/Detection2DArray": "std_msgs/Header header\nDetection2D[] detections",
    "vision_msgs/msg/Detection3D": """
std_msgs/Header header
ObjectHypothesisWithPose[] results
BoundingBox3D bbox
string id
""",
    "vision_msgs/msg/Detection3DArray": "std_msgs/Header header\nDetection3D[] detections",
}


def compare(where, expected, seen):
    if isinstance(expected, dict):
        for name, value in expected.items():
            compare(f"{where}.{name}", value, getattr(seen, name))
    elif isinstance(expected, list):
        assert len(expected) == len(seen), f"{where}: {len(expected)} elements, read {len(seen)}"
        for i, value in enumerate(expected):
            compare(f"{where}[{i}]", value, seen[i])
    elif isinstance(expected, str) and not isinstance(seen, str):
        assert float.fromhex(expected) == float(seen), f"{where}: {expected}, read {seen}"
    elif isinstance(expected, int) and not isinstance(expected, bool) and int(seen) < 0 <= expected:
        assert expected == int(seen) & 0xFF, f"{where}: {expected}, read {seen}"  # a byte
    else:
        assert expected == seen, f"{where}: {expected}, read {seen}"


def check_summary(file, summary, count):
    """What `mcap doctor` looks at: statistics and indexes agree with the chunks that they are of."""
    statistics, chunks, messages = summary.statistics, {}, {}
    size = file.stat().st_size
    with open(file, "rb") as stream:
        for record in StreamReader(stream, emit_chunks=True, validate_crcs=True).records:
            if isinstance(record, Chunk):
                inner = breakup_chunk(record, validate_crc=True)
                times = [each.log_time for each in inner if isinstance(each, Message)]
                chunks[len(chunks)] = (record.message_start_time, record.message_end_time, len(record.data))
                assert not times or (min(times), max(times)) == chunks[len(chunks) - 1][:2]
                for each in inner:
                    if isinstance(each, Message):
                        messages[each.channel_id] = messages.get(each.channel_id, 0) + 1
    indexed = sorted(summary.chunk_indexes, key=lambda index: index.chunk_start_offset)
    assert chunks == {i: (index.message_start_time, index.message_end_time, index.compressed_size)
                      for i, index in enumerate(indexed)}
    for index, after in zip(indexed, indexed[1:] + [None]):
        end = index.chunk_start_offset + index.chunk_length
        assert end + index.message_index_length <= (after.chunk_start_offset if after else size)
        assert all(end <= offset < end + index.message_index_length for offset in index.message_index_offsets.values())
    assert statistics.message_count == count == sum(messages.values())
    assert statistics.channel_message_counts == messages
    assert statistics.chunk_count == len(chunks) and statistics.channel_count == len(summary.channels)
    assert statistics.schema_count == len(summary.schemas)
    assert statistics.message_start_time == min(start for start, _, _ in chunks.values())
    assert statistics.message_end_time == max(end for _, end, _ in chunks.values())
    assert all(channel.schema_id in summary.schemas for channel in summary.channels.values())


def check_with_mcap(file, expected):
    with open(file, "rb") as stream:
        records = sum(1 for _ in StreamReader(stream, validate_crcs=True).records)
    with open(file, "rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        summary = reader.get_summary()
        topics = {channel.topic for _, channel, _ in reader.iter_messages()}
        count = sum(1 for _ in reader.iter_messages())
    assert topics == set(expected), topics ^ set(expected)
    assert records > count
    check_summary(file, summary, count)
    for channel in summary.channels.values():
        assert channel.metadata["topic_type_hash"] == expected[channel.topic]["hash"], channel.topic


def main():
    file, expected = Path(sys.argv[1]), json.loads(Path(sys.argv[2]).read_text())
    check_with_mcap(file, expected)
    humble, jazzy = get_typestore(Stores.ROS2_HUMBLE), get_typestore(Stores.ROS2_JAZZY)
    for store in (humble, jazzy):
        for name, text in FOREIGN_TYPES.items():
            store.register(get_types_from_msg(text, name))
    compared = 0
    with AnyReader([file]) as reader:
        for connection, _, raw in reader.messages():
            own, kind = expected[connection.topic], connection.msgtype
            assert jazzy.hash_rihs01(kind) == own["hash"], kind
            compare(connection.topic, own["message"], reader.deserialize(raw, kind))
            compare(connection.topic, own["message"], jazzy.deserialize_cdr(raw, kind))
            assert bytes(jazzy.serialize_cdr(jazzy.deserialize_cdr(raw, kind), kind)) == bytes(raw), kind
            if kind != "sensor_msgs/msg/Range":  # which has one field less in Humble
                assert humble.hash_rihs01(kind) == own["hash"], kind
                compare(connection.topic, own["message"], humble.deserialize_cdr(raw, kind))
            compared += 1
    assert compared == len(expected)
    print(f"{compared} messages")


main()
