#include "program/live/foxglove_services.h"

#include <cstdint>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include <simvis/error.h>
#include "engine/base/binary_numbers.h"
#include "exchange/messages/cdr.h"
#include "exchange/messages/types/service_types.h"

namespace simvis::live {
namespace {

constexpr char kResponse = 3;  // kind of a binary message: the answer to a call

}  // namespace

nlohmann::json advertised_services() {
  nlohmann::json services = nlohmann::json::array();
  for (std::size_t i = 0; i < std::size(kFoxgloveServices); ++i) {
    services.push_back({{"id", i + 1},
                        {"name", kFoxgloveServices[i].name},
                        {"type", "std_srvs/srv/Trigger"},
                        {"requestSchema", ""},
                        {"responseSchema", "bool success\nstring message\n"}});
  }
  return {{"op", "advertiseServices"}, {"services", std::move(services)}};
}

ServiceCall read_service_call(std::string_view message) {
  constexpr std::size_t kHead = 1 + 3 * sizeof(std::uint32_t);
  if (message.size() < kHead) throw InputError("this is no call of a service");
  const auto size = binary_at<std::uint32_t>(message, 9);
  if (size > message.size() - kHead) throw InputError("this is no call of a service");
  return {.service = binary_at<std::uint32_t>(message, 1),
          .id = binary_at<std::uint32_t>(message, 5),
          .encoding = std::string(message.substr(kHead, size))};
}

std::string service_answer(const ServiceCall& call, bool success, const std::string& text) {
  std::string bytes{kResponse};
  append_binary(bytes, call.service);
  append_binary(bytes, call.id);
  append_binary(bytes, static_cast<std::uint32_t>(call.encoding.size()));
  bytes += call.encoding;
  if (call.encoding == "cdr") return bytes + ros::encode(ros::TriggerResponse{success, text});
  const nlohmann::json answer = {{"success", success}, {"message", text}};
  return bytes + answer.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace simvis::live
