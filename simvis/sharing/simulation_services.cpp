#include "simvis/sharing/simulation_services.h"

#include <algorithm>
#include <iterator>
#include <new>
#include <span>

#include <simvis/location.h>
#include <simvis/part_importer.h>
#include <simvis/version.h>
#include "engine/base/assert.h"
#include "exchange/messages/cdr.h"
#include "simvis/sharing/network.h"
#include "simvis/simulation_use.h"

namespace simvis {

using Features = ros::SimulatorFeatures;
using Result = ros::SimulationResult;
using State = ros::SimulationState;

struct SimulationServices::Service {
  std::string_view name, type;
  bool changes;  // it is executed only with SimulationServicesDesc::changes
  std::vector<std::uint16_t> features;
  std::string (SimulationServices::*reply)(std::string_view request, bool allowed);
};

namespace {

constexpr std::string_view kStepService = "step_simulation", kResetService = "reset_simulation";

bool is_rest(const ros::Vector3& linear, const ros::Vector3& angular) {
  return linear.x == 0 && linear.y == 0 && linear.z == 0 && angular.x == 0 && angular.y == 0 && angular.z == 0;
}

}  // namespace

const std::vector<SimulationServices::Service>& SimulationServices::services() {
  using S = SimulationServices;
  static const std::vector<Service> all = {
      {"get_simulator_features", "GetSimulatorFeatures", false, {}, &S::reply<&S::get_features>},
      {"get_entities", "GetEntities", false, {}, &S::reply<&S::get_entities>},
      {"get_entity_state", "GetEntityState", false, {Features::kStateGetting}, &S::reply<&S::get_state>},
      {"get_entities_states", "GetEntitiesStates", false, {}, &S::reply<&S::get_states>},
      {"set_entity_state", "SetEntityState", true, {Features::kStateSetting}, &S::reply<&S::set_state>},
      {"spawn_entity", "SpawnEntity", true, {Features::kSpawning}, &S::reply<&S::spawn>},
      {"spawn_entities", "SpawnEntities", true, {Features::kSpawningEntities}, &S::reply<&S::spawn_all>},
      {"delete_entity", "DeleteEntity", true, {Features::kDeleting}, &S::reply<&S::remove>},
      {"get_simulation_state",
       "GetSimulationState",
       false,
       {Features::kSimulationStateGetting},
       &S::reply<&S::get_run>},
      {"set_simulation_state",
       "SetSimulationState",
       true,
       {Features::kSimulationStateSetting, Features::kPause},
       &S::reply<&S::set_run>},
      {kStepService, "StepSimulation", true, {Features::kStepSingle, Features::kStepMultiple}, &S::reply<&S::step>},
      {kResetService, "ResetSimulation", true, {Features::kReset, Features::kResetSpawned}, &S::reply<&S::reset>}};
  return all;
}

template <auto kFill>
std::string SimulationServices::reply(std::string_view request, bool allowed) {
  return filled(kFill, request, allowed);
}

template <typename Request, typename Reply>
std::string SimulationServices::filled(void (SimulationServices::*fill)(const Request&, Reply&), std::string_view bytes,
                                       bool allowed) {
  const auto request = ros::decode<Request>(bytes);
  Reply reply;
  reply.header = request.header;
  if constexpr (requires { reply.result; }) {
    try {
      if (!allowed && desc_.changes) throw ServiceRefusal(Result::kIncorrectState, "the run has ended");
      if (!allowed) throw ServiceRefusal(Result::kUnsupported, "expected a simulation with --dds-requests");
      (this->*fill)(request, reply);
    } catch (const ServiceRefusal& refusal) {
      reply.result = {refusal.result, refusal.what()};
    } catch (const Error& error) {  // of the machine too: a request that takes too long does not end the run
      reply.result = {Result::kFailed, without_file_content(error.what(), bytes)};
    } catch (const std::bad_alloc&) {
      reply.result = {Result::kFailed, std::string(kNoMemoryForRequest)};
    }
  } else {
    (this->*fill)(request, reply);
  }
  return ros::encode(reply);
}

SimulationServices::SimulationServices(Simulation& simulation, RunControl& control, SimulationServicesDesc desc)
    : simulation_(simulation), control_(control), desc_(std::move(desc)), entities_(simulation, desc_.folders) {
  if (!desc_.resets) {
    no_reset_ = "the run has files or other consumers that can't go back in time";
  } else if (desc_.changes) {
    try {
      start_ = simulation.save_state();
    } catch (const InputError& error) {  // a sensor of a plug-in has no state that can be saved
      no_reset_ = error.what();
    }
  }
  const SimulationUse use = simulation.impl();
  Network* const network = use->outlets.find<Network>();
  if (network == nullptr) return;
  for (const Service& each : services()) {
    network->serve(each.name, "simulation_interfaces/srv/" + std::string(each.type));
  }
}

void SimulationServices::serve() {
  const SimulationUse use = simulation_.impl();
  Network* const network = use->outlets.find<Network>();
  if (network == nullptr) return;
  if (!control_.makes_frame() && !ended_) {
    network->take(use->scene.built, use->moved_to_ns,
                  [&](std::span<const Command> commands) { use->execute_request(commands); });
    network->send_said(use->moved_to_ns);
  }
  for (const Service& each : services()) {
    network->answer(each.name, [&](std::string_view bytes) { return answer(each.name, bytes); });
  }
  if (steps_ && (control_.is_playing() || control_.steps() == 0)) end_steps("the run was paused or played meanwhile");
  if (std::optional<std::string> sent = take_step_reply()) network->send_reply(kStepService, *std::move(sent));
}

std::optional<std::string> SimulationServices::answer(std::string_view service, std::string_view request) {
  const auto found = std::ranges::find(services(), service, &Service::name);
  SIMVIS_ASSERT(found != services().end());
  std::string bytes = (this->*found->reply)(request, !found->changes || (desc_.changes && !ended_));
  if (std::exchange(replies_later_, false)) return std::nullopt;
  return bytes;
}

void SimulationServices::follow_frame() {
  stopped_ = false;
  entities_.forget_places();
  if (!steps_ || --steps_->left > 0) return;
  step_reply_ = ros::encode(ros::ResultReply{.header = steps_->header, .result = {}});
  steps_.reset();
}

void SimulationServices::end_steps(const std::string& why) {
  if (!steps_) return;
  const std::string made = std::to_string(steps_->wanted - steps_->left) + " of " + std::to_string(steps_->wanted);
  step_reply_ = ros::encode(
      ros::ResultReply{.header = steps_->header, .result = {Result::kFailed, made + " steps were made: " + why}});
  steps_.reset();
}

void SimulationServices::end() {
  ended_ = true;
  end_steps("the run has ended");
}

void SimulationServices::end_early(Simulation& simulation) { simulation.impl()->outlets.end_early(); }

bool SimulationServices::is_changed() const {
  const SimulationUse use = simulation_.impl();
  const Network* const network = use->outlets.find<Network>();
  return control_.is_changed() || (network != nullptr && network->is_changed());
}

void SimulationServices::get_features(const ros::EmptyRequest& /*request*/, ros::GetSimulatorFeaturesReply& reply) {
  for (const Service& each : services()) {
    if (desc_.changes || !each.changes) std::ranges::copy(each.features, std::back_inserter(reply.features.features));
  }
  if (!no_reset_.empty()) std::erase(reply.features.features, Features::kReset);
  if (desc_.changes) {
    for (const std::string& ending : known_part_endings()) reply.features.spawn_formats.push_back(ending.substr(1));
  }
  reply.features.custom_info = "SimVis " + std::string(version());
}

void SimulationServices::get_entities(const ros::EntitiesRequest& request, ros::GetEntitiesReply& reply) {
  reply.entities = entities_.names(request.filters);
}

void SimulationServices::get_state(const ros::EntityRequest& request, ros::GetEntityStateReply& reply) {
  const std::optional<ros::EntityState> state = entities_.state(request.entity);
  if (!state) throw ServiceRefusal(Result::kFailed, in_quotes(request.entity) + " is switched off, so it has no pose");
  reply.state = *state;
}

void SimulationServices::get_states(const ros::EntitiesRequest& request, ros::GetEntitiesStatesReply& reply) {
  const std::vector<std::string> names = entities_.names(request.filters);
  const std::vector<std::optional<ros::EntityState>> states = entities_.states(names);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!states[i]) continue;
    reply.entities.push_back(names[i]);
    reply.states.push_back(*states[i]);
  }
}

void SimulationServices::set_state(const ros::SetEntityStateRequest& request, ros::ResultReply& /*reply*/) {
  const ros::EntityState& state = request.state;
  if (request.set_twist && !(request.set_pose && is_rest(state.twist.linear, state.twist.angular))) {
    throw ServiceRefusal(Result::kFailed,
                         "the twist can't be set, expected 0 beside a pose, which puts a body at rest");
  }
  if (request.set_acceleration && !is_rest(state.acceleration.linear, state.acceleration.angular)) {
    throw ServiceRefusal(Result::kFailed, "the acceleration can't be set, expected 0");
  }
  if (!request.set_pose) {
    static_cast<void>(entities_.state(request.entity));  // throws if there is none
    return;
  }
  entities_.place(request.entity, state);
  control_.note_change();
}

void SimulationServices::spawn(const ros::SpawnEntityRequest& request, ros::SpawnEntityReply& reply) {
  reply.entity_name = entities_.spawn(request.spawn);
  control_.note_change();
}

void SimulationServices::spawn_all(const ros::SpawnEntitiesRequest& request, ros::SpawnEntitiesReply& reply) {
  constexpr std::size_t kMaxSpawned = 256;  // each one builds the scene anew, and the run waits
  if (request.spawn_requests.size() > kMaxSpawned) {
    throw ServiceRefusal(Result::kFailed, std::to_string(request.spawn_requests.size()) +
                                              " entities, expected at most " + std::to_string(kMaxSpawned) +
                                              " in one request");
  }
  bool all = true;
  for (const ros::EntitySpawn& each : request.spawn_requests) {
    ros::SpawnResult& one = reply.results.emplace_back();
    try {
      one.entity_name = entities_.spawn(each);
      control_.note_change();
      continue;
    } catch (const ServiceRefusal& refusal) {
      one.result = {refusal.result, refusal.what()};
    } catch (const Error& error) {
      one.result = {Result::kFailed, without_file_content(error.what(), each.entity_resource.uri + each.name)};
    }
    all = false;
  }
  if (all) return;
  throw ServiceRefusal(ros::SpawnEntitiesReply::kSpawnFailed, "some entities could not be spawned, see their results");
}

void SimulationServices::remove(const ros::EntityRequest& request, ros::ResultReply& /*reply*/) {
  entities_.remove(request.entity);
  control_.note_change();
}

std::uint8_t SimulationServices::run_state() const {
  if (quits_) return State::kQuitting;
  if (control_.makes_frame()) return State::kPlaying;
  return stopped_ ? State::kStopped : State::kPaused;
}

void SimulationServices::get_run(const ros::EmptyRequest& /*request*/, ros::GetSimulationStateReply& reply) {
  reply.state.state = run_state();
}

// While a client's steps are made, the state is "playing", and to play is a change: the run then goes on.
void SimulationServices::set_run(const ros::SetSimulationStateRequest& request, ros::ResultReply& /*reply*/) {
  using Request = ros::SetSimulationStateRequest;
  const std::uint8_t target = request.state.state;
  if (target > State::kQuitting || quits_) {
    throw ServiceRefusal(Request::kIncorrectTransition,
                         "state " + std::to_string(target) +
                             " can't be set, expected 0, stopped, 1, playing, 2, paused, or once 3, quitting");
  }
  const bool is_in_target = target == State::kPlaying ? control_.is_playing() : target == run_state();
  if (is_in_target) throw ServiceRefusal(Request::kAlreadyInTargetState, "the simulation is in this state already");
  switch (target) {
    case State::kPlaying:
      return control_.play();
    case State::kPaused:
      stopped_ = false;
      return control_.pause();
    case State::kStopped:
      return stop();
    default:
      return quit();
  }
}

void SimulationServices::quit() {
  control_.pause();
  quits_ = true;
  desc_.quit();
}

void SimulationServices::require_reset() const {
  if (!no_reset_.empty()) throw ServiceRefusal(Result::kUnsupported, no_reset_);
}

void SimulationServices::stop() {
  require_reset();
  try {
    restart();
  } catch (const InputError& error) {
    throw ServiceRefusal(ros::SetSimulationStateRequest::kTransitionError, without_file_content(error.what(), ""));
  }
  control_.pause();
  stopped_ = true;
}

void SimulationServices::step(const ros::StepSimulationRequest& request, ros::ResultReply& /*reply*/) {
  if (control_.makes_frame()) throw ServiceRefusal(Result::kFailed, "the simulation is not paused");
  if (request.steps == 0) throw ServiceRefusal(Result::kFailed, "0 steps, expected 1 or more");
  control_.step(request.steps);
  steps_ = {.header = request.header, .wanted = request.steps, .left = request.steps};
  replies_later_ = true;
}

void SimulationServices::reset(const ros::ResetSimulationRequest& request, ros::ResultReply& /*reply*/) {
  using Request = ros::ResetSimulationRequest;
  constexpr std::uint8_t kEach = Request::kTime | Request::kState | Request::kSpawned;
  const bool is_all = request.scope == Request::kDefault || (request.scope & kEach) == kEach;
  if (!is_all && request.scope != Request::kSpawned) {
    throw ServiceRefusal(Result::kUnsupported, "scope " + std::to_string(request.scope) +
                                                   ", expected 0, 7 or 255, all, or 4, the entities that were spawned");
  }
  if (is_all) require_reset();
  is_all ? restart() : entities_.remove_spawned();
  if (!control_.is_playing()) control_.pause();  // without the steps that are left
}

void SimulationServices::restart() {
  control_.note_change();
  entities_.remove_added();
  simulation_.restore_state(start_);
  control_.restart_clock();
}

}  // namespace simvis
