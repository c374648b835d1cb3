#include "live/foxglove_assets.h"

#include <cstddef>
#include <fstream>
#include <system_error>

#include <simvis/location.h>
#include "live/foxglove_numbers.h"

namespace simvis::live {
namespace {

constexpr char kAssetResponse = 4;  // kind of a binary message
constexpr char kSuccess = 0, kError = 1;
constexpr std::size_t kMaxAsset_bytes = std::size_t{64} << 20;

std::string answer_of(const AssetRequest& request, char status, const std::string& error) {
  std::string bytes{kAssetResponse};
  append_number(bytes, request.id);
  bytes += status;
  append_number(bytes, static_cast<std::uint32_t>(error.size()));
  return bytes + error;
}

}  // namespace

std::string asset_answer(const AssetFiles& files, const AssetRequest& request) {
  const auto fail = [&](const std::string& why) { return answer_of(request, kError, in_quotes(request.uri) + why); };
  const auto found = files.find(request.uri);
  if (found == files.end()) return fail(": no description of a robot names such a file");
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(found->second, error);
  if (error) return fail(" cannot be read");  // also if it is no regular file, which is never opened
  if (size > kMaxAsset_bytes) return fail(" is larger than 64 MiB");
  std::ifstream in(found->second, std::ios::binary);
  std::string bytes = answer_of(request, kSuccess, "");
  const std::size_t head = bytes.size();
  bytes.resize(head + size);
  if (!in.read(bytes.data() + head, static_cast<std::streamsize>(size))) return fail(" cannot be read");
  return bytes;
}

}  // namespace simvis::live
