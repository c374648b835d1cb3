// Answers of std_srvs.
#pragma once

#include <string>
#include <string_view>

#include "exchange/messages/field.h"

namespace simvis::ros {

struct TriggerResponse {
  SIMVIS_MESSAGE("std_srvs/srv/Trigger_Response", success, message);
  bool success = false;
  std::string message;
};

}  // namespace simvis::ros
