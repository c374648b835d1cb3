#include "program/live/foxglove_assets.h"

#include <cstddef>
#include <optional>

#include <simvis/error.h>
#include <simvis/location.h>
#include "engine/base/binary_numbers.h"
#include "simvis/message_tap.h"

namespace simvis::live {
namespace {

constexpr char kAssetResponse = 4;  // kind of a binary message
constexpr char kSuccess = 0, kError = 1;
constexpr std::size_t kMaxAsset_bytes = std::size_t{64} << 20;

std::string answer_of(const AssetRequest& request, char status, const std::string& error) {
  std::string bytes{kAssetResponse};
  append_binary(bytes, request.id);
  bytes += status;
  append_binary(bytes, static_cast<std::uint32_t>(error.size()));
  return bytes + error;
}

}  // namespace

std::string asset_answer(const AssetFiles& files, const AssetRequest& request) {
  const auto fail = [&](const std::string& why) { return answer_of(request, kError, in_quotes(request.uri) + why); };
  const auto found = files.find(request.uri);
  if (found == files.end()) return fail(": no description of a robot names such a file");
  try {
    const std::optional<std::string> bytes = read_robot_file(found->second, kMaxAsset_bytes);
    return bytes ? answer_of(request, kSuccess, "") + *bytes : fail(" is larger than 64 MiB");
  } catch (const Error&) {
    return fail(" cannot be read");  // whether it is there or not
  }
}

}  // namespace simvis::live
