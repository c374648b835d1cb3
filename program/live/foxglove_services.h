// The services that Foxglove's clients call: play, pause, one step, and saving the scene file. Requests are empty;
// answers are those of std_srvs/srv/Trigger, as CDR or JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "program/live/control.h"

namespace simvis::live {

struct FoxgloveService {
  std::string_view name;
  Control::Kind kind;
  std::string_view done;  ///< the answer's message if it was carried out
};

inline constexpr FoxgloveService kFoxgloveServices[] = {
    {"/simvis/play", Control::Kind::play, "the simulation goes on"},
    {"/simvis/pause", Control::Kind::pause, "the simulation is paused"},
    {"/simvis/step", Control::Kind::step, "one frame is made"},
    {"/simvis/save", Control::Kind::save, "the scene file is saved"},
};

/// The message `advertiseServices`; the id of a service is its place in the table, from 1.
nlohmann::json advertised_services();

/// Reads the call in a binary message. The service and the encoding are not checked. Throws InputError if the message
/// is too short.
ServiceCall read_service_call(std::string_view message);

/// The binary message that answers a call; its encoding is "cdr" or "json".
std::string service_answer(const ServiceCall& call, bool success, const std::string& text);

}  // namespace simvis::live
