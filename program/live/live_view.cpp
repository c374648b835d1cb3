#include "program/live/live_view.h"

#include <array>
#include <limits>
#include <utility>

#include "engine/base/now_ns.h"
#include "engine/base/words.h"
#include "program/live/foxglove_peer.h"
#include "program/live/page_assets.h"
#include "simvis/built_scene.h"
#include "simvis/message_tap.h"

namespace simvis::live {
namespace {

constexpr std::array kProtocols = {kViewProtocol, kFoxgloveProtocols[0], kFoxgloveProtocols[1]};

// The plan is text for people.
constexpr std::int64_t kPlanPeriod_ns = 500'000'000;

// No scene has had so many.
constexpr std::size_t kNoChanges = std::numeric_limits<std::size_t>::max();

// Frames that wait for the server, before further ones are left out.
constexpr int kMaxFrames = 2;

// The page loads its own files, shows pictures that it makes from messages, and connects to its server alone. The
// styles of its elements depend on values. Its inline scripts are the import map and the one that begins.
std::string content_policy(const std::string& nonce) {
  return "default-src 'self'; script-src 'self' 'nonce-" + nonce +
         "'; style-src 'self' 'unsafe-inline'; img-src 'self' blob: data:; connect-src 'self' blob: data:; "
         "object-src 'none'; base-uri 'none'; form-action 'none'";
}

// The page with the nonce at its inline scripts.
std::string with_nonce(std::string_view page, const std::string& nonce) {
  constexpr std::string_view kScript = "<script ";
  const std::string attribute = "nonce=\"" + nonce + "\" ";
  std::string text(page);
  for (std::size_t at = text.find(kScript); at != std::string::npos; at = text.find(kScript, at)) {
    at += kScript.size();
    text.insert(at, attribute);
  }
  return text;
}

std::optional<std::uint64_t> structure_of(std::string_view query) {
  constexpr std::string_view kName = "structure=";
  if (!query.starts_with(kName)) return std::nullopt;
  return as_number<std::uint64_t>(query.substr(0, query.find('&')).substr(kName.size()));
}

void add_measurements(const OtherMeasurements& others, const ViewWants& wants, ViewFrame& frame) {
  for (std::uint32_t i = 0; i < frame.scene->sensors.size(); ++i) {
    const ViewSensor& sensor = frame.scene->sensors[i];
    if (!wants.sensors.contains(sensor.name)) continue;
    const std::optional<Measurement> measurement = others(sensor.name, sensor.outputs);
    if (measurement) add_measurement(i, *measurement, frame);
  }
}

}  // namespace

LiveView::LiveView(const ServerDesc& desc, std::optional<PlaybackRange> range)
    : foxglove_(controls_, random_token(), range),
      view_(controls_, [this](ViewWants wants) { want(std::move(wants)); }),
      outlet_(foxglove_),
      server_(std::make_unique<Server>(desc, static_cast<Service&>(*this))) {}

LiveView::~LiveView() = default;

void LiveView::attach(Simulation& simulation) {
  send_messages(simulation, &outlet_);
  copier_.restart();
  parameters_.clear();
  changes_ = inputs_changes_ = kNoChanges;
}

void LiveView::want(ViewWants wants) {
  const std::lock_guard lock(mutex_);
  wants_ = std::move(wants);
}

ViewWants LiveView::take_wants() {
  ViewWants wants;
  {
    const std::lock_guard lock(mutex_);
    wants = wants_;
  }
  const std::int64_t now = now_ns();
  wants.plan = wants.plan && now - plan_ns_ >= kPlanPeriod_ns;
  if (wants.plan) plan_ns_ = now;
  return wants;
}

bool LiveView::publish(Simulation& simulation, const FrameTime& time, double step_ms, const ViewTime& view_time,
                       const OtherMeasurements& others) {
  if (std::function<void()> batch = outlet_.take_batch()) server_->post(std::move(batch));
  if (const std::size_t changes = simulation.parameters().changes().size(); changes != inputs_changes_) {
    inputs_changes_ = changes;
    server_->post([this, inputs = command_inputs(simulation), files = files_of_robots(simulation)] {
      foxglove_.set_command_inputs(inputs);
      foxglove_.set_assets(files);
    });
  }
  if (foxglove_.has_clients()) publish(simulation.parameters());
  if (foxglove_.has_clients() || foxglove_.offers_playback()) {
    server_->post([this, time_ns = time.time_ns] { foxglove_.set_time(time_ns); });
  }
  if (view_.viewers() == 0) return true;
  if (view_.can_show() == 0 || frames_under_way_ >= kMaxFrames) {
    copier_.skip(simulation, time);
    return false;
  }
  ++frames_under_way_;
  const ViewWants wants = take_wants();
  auto frame = std::make_shared<ViewFrame>(copier_.copy(simulation, time, step_ms, wants));
  if (others) add_measurements(others, wants, *frame);
  server_->post([this, frame, view_time] {
    --frames_under_way_;
    view_.publish(std::move(*frame), view_time);
  });
  return true;
}

void LiveView::publish(const ViewTime& view_time) {
  server_->post([this, view_time] { view_.set_time(view_time); });
}

void LiveView::publish(const PlaybackState& state) {
  server_->post([this, state] { foxglove_.set_playback(state); });
}

// Without a change they are copied for new clients alone.
void LiveView::publish(const Parameters& parameters) {
  const std::span<const double> values = parameters.values();
  const std::uint64_t arrivals = arrivals_;
  bool changed = std::exchange(known_arrivals_, arrivals) != arrivals;
  if (const std::size_t changes = parameters.changes().size(); changes != changes_) {
    changes_ = changes;
    changed = true;
    for (std::size_t i = parameters_.size(); i < values.size(); ++i)
      parameters_.push_back({.name = parameters.name(i)});
    for (std::size_t i = 0; i < values.size(); ++i) parameters_[i].removed = parameters.is_removed(i);
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (parameters_[i].value == values[i]) continue;
    parameters_[i].value = values[i];
    changed = true;
  }
  if (changed) server_->post([this, copy = parameters_] { foxglove_.set_parameters(copy); });
}

void LiveView::answer_set(const Control& request, std::vector<std::string> refusals, const Parameters& parameters) {
  publish(parameters);
  server_->post([this, request, refusals = std::move(refusals)] {
    foxglove_.answer_set(request, refusals);
    for (const std::string& refusal : refusals) view_.answer_error(request.client, "set", refusal);
  });
}

void LiveView::answer(const Control& request, const std::string& refusal) {
  server_->post([this, request, refusal] {
    if (request.call) return foxglove_.answer_call(request.client, *request.call, refusal);
    if (request.kind == Control::Kind::playback) return foxglove_.refuse(request.client, refusal);
    if (request.kind == Control::Kind::execute) foxglove_.answer_execute(request.client, refusal);
    if (request.kind == Control::Kind::command && !refusal.empty()) {
      return foxglove_.answer_execute(request.client, refusal);
    }
    if (!refusal.empty()) view_.answer_error(request.client, request.request, refusal);
  });
}

void LiveView::answer_saved(const Control& request, const std::string& xml) {
  if (request.call) return answer(request, "");
  server_->post([this, client = request.client, xml] { view_.answer_saved(client, xml); });
}

void LiveView::pull(const Control& request, Simulation& simulation) {
  std::string refusal;
  try {
    const std::shared_ptr<SensedPhysics> physics = find_physics(built_scene(simulation).scene);
    if (physics != nullptr) physics->pull(request.client, request.pull);
    if (physics == nullptr && request.pull) refusal = "the scene has no physics";
  } catch (const InputError& error) {
    refusal = error.what();
  }
  answer(request, refusal);
}

void LiveView::report(const std::string& about, const std::string& message) {
  server_->post([this, about, message] { view_.answer_all_error(about, message); });
}

std::optional<Answer> LiveView::get(std::string_view path, std::string_view query) {
  if (path == "/scene.glb") {
    const std::optional<std::uint64_t> structure = structure_of(query);
    std::shared_ptr<const std::string> glb = structure ? view_.glb(*structure) : nullptr;
    if (!glb) return std::nullopt;
    return Answer{.status = 200, .type = std::string(media_type("scene.glb")), .body = std::move(glb)};
  }
  const std::string_view name = path == "/" ? "index.html" : path.substr(1);
  const std::string_view bytes = page_asset(name);
  if (bytes.empty()) return std::nullopt;
  if (name == "index.html") {
    return Answer{.status = 200,
                  .type = std::string(media_type(name)),
                  .body = std::make_shared<const std::string>(with_nonce(bytes, nonce_)),
                  .policy = content_policy(nonce_)};
  }
  return Answer{.status = 200, .type = std::string(media_type(name)), .body = std::make_shared<std::string>(bytes)};
}

std::span<const std::string_view> LiveView::protocols() const { return kProtocols; }

std::unique_ptr<Peer> LiveView::connect(std::string_view protocol) {
  const ClientId client = next_client_++;
  if (protocol == kViewProtocol) return view_.connect(client);
  foxglove_.await_parameters();
  auto peer = std::make_unique<FoxglovePeer>(foxglove_, client);
  ++arrivals_;  // behind the client, which is then there when the simulation's thread counts
  controls_.add({.kind = Control::Kind::look, .client = client});
  return peer;
}

}  // namespace simvis::live
