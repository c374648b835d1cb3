// Files of HDF5, of the kind that every reader of HDF5 takes: the first version of the format, with groups, and
// datasets that lie in one piece without compression.
//
// Source   "HDF5 File Format Specification Version 3.0", The HDF Group (support.hdfgroup.org): superblock 0, object
//          headers 1, groups as B-trees 1 with a local heap, data layout 3.
// Why      The library of HDF5 is 4 MB with its dependencies, to write arrays one behind the other.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace simvis {

/// Little-endian numbers.
enum class H5Type : std::uint8_t { u8, u16, u32, u64, i64, f32 };

struct H5Dataset {
  H5Type type = H5Type::u8;
  std::vector<std::uint64_t> shape;  ///< rows first; empty: a single number
  std::string bytes;                 ///< of all numbers, by rows
};

/// Datasets by their names. A group has at least one and at most kMaxH5Members.
using H5Group = std::map<std::string, H5Dataset>;
inline constexpr std::size_t kMaxH5Members = 8;

/// A file with the datasets of the group "" at the top, and the other groups with theirs; at the top as well there are
/// at most kMaxH5Members (asserted). The bytes of each dataset are those of its shape (asserted).
std::string encode_h5(const std::map<std::string, H5Group>& groups);

}  // namespace simvis
