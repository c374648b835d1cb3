// Attributes that say how ROS 2 messages have the points of a sensor. Sensors ignore them; simvis/sensor_messages.cpp
// reads them.
#pragma once

#include <simvis/attributes.h>

namespace simvis {

/// Of scanners.
inline constexpr AttributeSpec kLayoutAttribute{
    .name = "layout",
    .kind = AttributeKind::choice,
    .default_value = "simvis",
    .text = "fields of its PointCloud2: all that it measures, or those of a driver; livox: also its CustomMsg",
    .choices = "simvis velodyne ouster livox"};

/// Of scanners and of cameras with depth.
inline constexpr AttributeSpec kDenseAttribute{.name = "dense",
                                               .kind = AttributeKind::choice,
                                               .default_value = "off",
                                               .text = "on: its PointCloud2 leaves out points that are NaN",
                                               .choices = "off on"};

}  // namespace simvis
