// Attributes that commands have beside those of a type: each is allowed by the reader and printed by
// `simvis-run --describe`.
#pragma once

#include <simvis/attributes.h>
#include "scenegraph/language/pose_attribute.h"

namespace simvis {

inline constexpr AttributeSpec kTypeRow{
    .name = "type", .kind = AttributeKind::text, .text = "required: the type; --list-types prints all"};
inline constexpr AttributeSpec kNameRow{
    .name = "name", .kind = AttributeKind::text, .text = "required: a name that no other of its kind has"};
inline constexpr AttributeSpec kInsertAtRow{
    .name = "insert_at", .kind = AttributeKind::part, .text = "required: an insertion point; ROOT, or that of a part"};
inline constexpr AttributeSpec kPoseOffsetRow{
    .name = kPoseOffset,
    .kind = AttributeKind::text,
    .text = "fixed offset \"x y z roll pitch yaw\" in metres and degrees; 0 if not given"};
inline constexpr AttributeSpec kQuaternionRow{
    .name = kQuaternion,
    .kind = AttributeKind::text,
    .text = "orientation \"w x y z\" of length 1; pose_offset is then \"x y z\""};
inline constexpr AttributeSpec kLookAtRow{
    .name = kLookAt,
    .kind = AttributeKind::text,
    .text = "a point \"x y z\" or a part at which the sensor looks; pose_offset is then \"x y z\""};
inline constexpr AttributeSpec kFrameRow{.name = "frame",
                                         .kind = AttributeKind::text,
                                         .text = "frame_id of its ROS 2 messages; the sensor's name if not given"};
inline constexpr AttributeSpec kTopicsRow{
    .name = "topics",
    .kind = AttributeKind::text,
    .text = "other ROS 2 topics: \"scan:=/scan\" renames one, \"*:=/front\" is the folder of all others"};
inline constexpr AttributeSpec kFileRow{
    .name = "file", .kind = AttributeKind::file, .text = "part file, relative to the file that has the command"};

inline constexpr AttributeSpec kPartCommonRows[] = {kFileRow, kNameRow, kInsertAtRow, kPoseOffsetRow, kQuaternionRow};
inline constexpr AttributeSpec kElementCommonRows[] = {kTypeRow, kNameRow, kInsertAtRow};
inline constexpr AttributeSpec kSensorCommonRows[] = {kTypeRow,       kNameRow,   kInsertAtRow, kPoseOffsetRow,
                                                      kQuaternionRow, kLookAtRow, kFrameRow,    kTopicsRow};
inline constexpr AttributeSpec kRemoveCommonRows[] = {kNameRow};
inline constexpr AttributeSpec kRemoveRows[] = {{
    .name = "kind",
    .kind = AttributeKind::choice,
    .text = "what has the name, if a part, an element or a sensor have the same",
    .choices = "part element sensor",
}};

}  // namespace simvis
