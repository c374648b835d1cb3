// A pendulum and an arm as URDF, whose masses and levers tests know.
#pragma once

#include <string>

#include <simvis/attributes.h>

namespace simvis::test {

inline std::string inertial(double mass, const std::string& at, double moment) {
  const std::string m = format_number(moment);
  return "<inertial><origin xyz='" + at + "'/><mass value='" + format_number(mass) + "'/><inertia ixx='" + m +
         "' iyy='" + m + "' izz='" + m + "' ixy='0' ixz='0' iyz='0'/></inertial>";
}
inline std::string visual(const std::string& size, const std::string& at) {
  return "<visual><origin xyz='" + at + "'/><geometry><box size='" + size + "'/></geometry></visual>";
}

// A bar of 1 kg and 1 m that hangs from a joint about y, and turns from +x.
inline const std::string kPendulum =
    "<robot name='p'><link name='base'>" + visual("0.1 0.1 0.1", "0 0 0") + "</link><link name='bar'>" +
    visual("1 0.02 0.02", "0.5 0 0") + inertial(1, "0.5 0 0", 1.0 / 12) +
    "</link><joint name='swing' type='continuous'><parent link='base'/><child link='bar'/>"
    "<axis xyz='0 1 0'/></joint></robot>";

// Two links of 0.5 m and 2 kg each, that reach along +x; a gripper of 0.5 kg is fixed to the second.
inline const std::string kArm =
    "<robot name='arm'><link name='base'>" + visual("0.2 0.2 0.2", "0 0 0") + "</link><link name='upper'>" +
    visual("0.5 0.05 0.05", "0.25 0 0") + inertial(2, "0.25 0 0", 0.05) + "</link><link name='lower'>" +
    visual("0.5 0.05 0.05", "0.25 0 0") + inertial(2, "0.25 0 0", 0.05) + "</link><link name='grip'>" +
    inertial(0.5, "0 0 0", 0.001) +
    "</link><joint name='shoulder' type='revolute'><parent link='base'/><child link='upper'/><axis xyz='0 1 0'/>"
    "<limit lower='-1.5' upper='1.5' effort='100' velocity='2'/></joint>"
    "<joint name='elbow' type='revolute'><parent link='upper'/><child link='lower'/><origin xyz='0.5 0 0'/>"
    "<axis xyz='0 1 0'/><limit lower='-2' upper='2' effort='50' velocity='2'/></joint>"
    "<joint name='wrist' type='fixed'><parent link='lower'/><child link='grip'/><origin xyz='0.5 0 "
    "0'/></joint></robot>";

}  // namespace simvis::test
