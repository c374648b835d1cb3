// The services of simulation_interfaces by which ROS 2 controls a run: entities that come, go and are put elsewhere,
// and a simulation that plays, pauses, steps and starts again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/simulation.h>
#include "engine/base/program_api.h"
#include "exchange/messages/types/simulation_types.h"
#include "simvis/sharing/run_control.h"
#include "simvis/sharing/scene_entities.h"

namespace simvis {

/// What clients may do.
struct SimulationServicesDesc {
  bool changes = false;                          ///< as DdsDesc::requests: services that change something are executed
  bool resets = false;                           ///< whatever takes the frames can go back in time
  std::vector<std::filesystem::path> folders{};  ///< below which resources of spawned entities lie
  std::function<void()> quit{};                  ///< ends the run before its next frame
};

/// The services of a simulation that takes part in DDS; without DDS, answer() alone works. Entities are the parts of
/// the scene.
///
/// Errors   what a request asks for in vain is in the reply, as Result.msg and the service say.
/// Threads  that of the simulation, between frames.
class SimulationServices {
 public:
  /// Saves the state to which a reset returns. `simulation` and `control` must outlive it. Throws InputError: a folder
  /// is not there. MachineError: DDS fails.
  SIMVIS_PROGRAM_API SimulationServices(Simulation& simulation, RunControl& control, SimulationServicesDesc desc);

  /// Answers the requests that wait. If the run is paused, it also takes what else has come by DDS; otherwise each
  /// frame does so.
  SIMVIS_PROGRAM_API void serve();
  /// The reply to a request of a service such as "spawn_entity", both in CDR with their headers. Empty: it comes when
  /// its steps are made. Throws InputError for bytes that are no request of the service.
  std::optional<std::string> answer(std::string_view service, std::string_view request);
  /// After each frame.
  SIMVIS_PROGRAM_API void follow_frame();
  /// The steps that a client waits for are not made, if there are any.
  SIMVIS_PROGRAM_API void end_steps(const std::string& why);
  /// The run makes no frame more: changes are refused from now on.
  SIMVIS_PROGRAM_API void end();
  /// Tells recordings and DDS that no frame follows, although more were wanted. They then do not warn of patterns that
  /// no topic has matched, because a later frame could have had the topic. The simulation need not have services.
  SIMVIS_PROGRAM_API static void end_early(Simulation& simulation);
  /// Whether a client has changed the scene, so that an error of a step may be its own.
  SIMVIS_PROGRAM_API bool is_changed() const;
  /// The reply to the steps that have been made or have failed since the last call; serve() sends it.
  std::optional<std::string> take_step_reply() { return std::exchange(step_reply_, std::nullopt); }

 private:
  struct Service;
  static const std::vector<Service>& services();
  template <auto kFill>
  std::string reply(std::string_view request, bool allowed);
  template <typename Request, typename Reply>
  std::string filled(void (SimulationServices::*fill)(const Request&, Reply&), std::string_view bytes, bool allowed);

  void get_features(const ros::EmptyRequest& request, ros::GetSimulatorFeaturesReply& reply);
  void get_entities(const ros::EntitiesRequest& request, ros::GetEntitiesReply& reply);
  void get_state(const ros::EntityRequest& request, ros::GetEntityStateReply& reply);
  void get_states(const ros::EntitiesRequest& request, ros::GetEntitiesStatesReply& reply);
  void set_state(const ros::SetEntityStateRequest& request, ros::ResultReply& reply);
  void spawn(const ros::SpawnEntityRequest& request, ros::SpawnEntityReply& reply);
  void spawn_all(const ros::SpawnEntitiesRequest& request, ros::SpawnEntitiesReply& reply);
  void remove(const ros::EntityRequest& request, ros::ResultReply& reply);
  void get_run(const ros::EmptyRequest& request, ros::GetSimulationStateReply& reply);
  void set_run(const ros::SetSimulationStateRequest& request, ros::ResultReply& reply);
  void step(const ros::StepSimulationRequest& request, ros::ResultReply& reply);
  void reset(const ros::ResetSimulationRequest& request, ros::ResultReply& reply);

  std::uint8_t run_state() const;
  void require_reset() const;
  void stop();
  void restart();
  void quit();

  Simulation& simulation_;
  RunControl& control_;
  SimulationServicesDesc desc_;
  SceneEntities entities_;
  std::string start_;                                     // the state to which a reset returns
  std::string no_reset_;                                  // why there is none; empty: there is one
  bool stopped_ = false, quits_ = false, ended_ = false;  // stopped: no frame has been made since
  struct Steps {
    ros::RequestHeader header;
    std::uint64_t wanted = 0, left = 0;
  };
  std::optional<Steps> steps_;  // that a client waits for
  bool replies_later_ = false;  // to the request that is being answered
  std::optional<std::string> step_reply_;
};

}  // namespace simvis
