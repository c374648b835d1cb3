// What the data packets of a real laser scanner need beyond its beams.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace simvis {

/// The packets of a device.
enum class PacketFormat : std::uint8_t {
  velodyne,  ///< 1206 bytes: twelve blocks of 32 lasers
  ouster,    ///< RNG19_RFL8_SIG16_NIR16: sixteen columns of all rings
};

/// How the lasers of a Velodyne device share its packets.
struct VelodynePackets {
  std::uint8_t model = 0;                      ///< the last byte of a packet
  double distance_unit_m = 0;                  ///< of the 16 bits of a distance
  std::uint32_t stamped_laser = 0;             ///< the laser of the first firing whose time stamps a packet
  std::vector<std::uint32_t> laser_of_ring{};  ///< place of each ring of the table in the firing order
};

/// What the metadata of an Ouster device say.
struct OusterPackets {
  std::uint32_t columns = 0;                 ///< of a full turn
  std::uint32_t first_column = 0;            ///< the measurement that the first beam of each ring belongs to
  std::uint32_t rate_hz = 0;                 ///< turns per second
  std::string product_line{};                ///< "OS-1-128"
  std::vector<double> azimuth_deg{},         ///< by ring, clockwise from the encoder's angle
      elevation_deg{};                       ///< by ring
  double beam_radius_mm = 0, beam_z_mm = 0;  ///< of the beams' origins in the frame of the lidar
  std::vector<double> lidar_to_sensor{};     ///< 16 numbers, row by row, in millimetres
};

struct ScannerDevice {
  std::string name;  ///< "Velodyne VLP-16"
  PacketFormat format = PacketFormat::velodyne;
  VelodynePackets velodyne{};  ///< of a Velodyne device
  OusterPackets ouster{};      ///< of an Ouster device
};

}  // namespace simvis
