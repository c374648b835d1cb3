// ZIP archives in memory, for .npz files.
#pragma once

#include <span>
#include <string>

namespace simvis {

/// One file of an archive.
struct ZipEntry {
  std::string name, content;
};

/// A ZIP archive without dates: the same entries give the same bytes. Each content and the archive have less than
/// 4 GiB (asserted).
std::string encode_zip(std::span<const ZipEntry> entries);

}  // namespace simvis
