// Answers of std_srvs.
#pragma once

#include <string>
#include <string_view>
#include <tuple>

#include "exchange/messages/field.h"

namespace simvis::ros {

struct TriggerResponse {
  static constexpr std::string_view kName = "std_srvs/srv/Trigger_Response";
  bool success = false;
  std::string message;
  static constexpr auto field_table() {
    return std::tuple{Field{"success", &TriggerResponse::success}, Field{"message", &TriggerResponse::message}};
  }
};

}  // namespace simvis::ros
