#include "program/live/view_hub.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include <simvis/error.h>
#include <simvis/location.h>
#include "program/live/glb_file.h"

namespace simvis::live {
namespace {

using ReceivedJson = nlohmann::json;

constexpr std::size_t kKeptScenes = 3;

bool same_structure(const ViewFrame* a, const ViewFrame& b) {
  return a != nullptr && a->scene->structure == b.scene->structure;
}

std::string glb_name(std::uint64_t structure) { return "scene.glb?structure=" + std::to_string(structure); }

double received_number(const ReceivedJson& json) {
  const double value = json.is_number() ? json.get<double>() : std::nan("");
  if (!std::isfinite(value)) throw InputError("expected a number");
  return value;
}

// Farther places are refused, because forces of springs to them would not be finite.
constexpr double kFarthest_m = 1e6;

glm::dvec3 received_point(const ReceivedJson& json) {
  if (!json.is_array() || json.size() != 3) throw InputError("expected three numbers");
  const glm::dvec3 point_m(received_number(json[0]), received_number(json[1]), received_number(json[2]));
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(point_m[axis]) > kFarthest_m) throw InputError("expected a place within 1e6 m");
  }
  return point_m;
}

std::uint32_t received_index(const ReceivedJson& json) {
  const std::int64_t index = json.is_number_integer() ? json.get<std::int64_t>() : -1;
  if (index < 0 || index > std::numeric_limits<std::uint32_t>::max()) throw InputError("expected an index");
  return static_cast<std::uint32_t>(index);
}

}  // namespace

ViewHub::ViewHub(ControlQueue& controls, std::function<void(ViewWants)> wanted)
    : controls_(controls), wanted_(std::move(wanted)) {}

std::unique_ptr<Peer> ViewHub::connect(ClientId client) { return std::make_unique<ViewPeer>(*this, client); }

// What a sensor has measured stays until it measures again: all of it, so that names which come and go do not add up. A
// new scene has other sensors.
void ViewHub::keep_measurements(ViewFrame& frame) {
  const bool same = same_structure(frame_.get(), frame);
  if (!same) measured_.clear();
  std::set<std::uint32_t> measured;
  for (const ViewScan& scan : frame.scans) measured.insert(scan.sensor);
  for (const ViewImage& image : frame.images) measured.insert(image.sensor);
  std::erase_if(measured_, [&](const auto& each) { return measured.contains(each.first.first); });
  for (ViewScan& scan : frame.scans) {
    const Output output{scan.sensor, ""};
    measured_[output] = {next_order_++, std::move(scan), std::nullopt, nullptr};
  }
  for (ViewImage& image : frame.images) {
    const Output output{image.sensor, image.array.name};
    measured_[output] = {next_order_++, std::nullopt, std::move(image), nullptr};
  }
  frame.scans.clear();
  frame.images.clear();
  if (!same) return;
  if (frame.plan.empty()) frame.plan = frame_->plan;
  std::set<std::uint32_t> read;
  for (const ViewTable& table : frame.tables) read.insert(table.sensor);
  for (const ViewTable& before : frame_->tables) {
    if (!read.contains(before.sensor)) frame.tables.push_back(before);
  }
}

void ViewHub::publish(ViewFrame frame, const ViewTime& time) {
  keep_measurements(frame);
  const bool same = same_structure(frame_.get(), frame);
  frame_ = std::make_shared<const ViewFrame>(std::move(frame));
  set_time(time);
  if (same) return;
  scenes_.push_back(frame_->scene);
  if (scenes_.size() > kKeptScenes) scenes_.pop_front();
  follow_wants();
}

void ViewHub::set_time(const ViewTime& time) {
  time_ = time;
  ++time_order_;
}

void ViewHub::answer_error(ClientId client, std::string_view about, std::string_view message) {
  const auto found = peers_.find(client);
  if (found != peers_.end()) found->second->texts_.add(error_message(about, message));
}

void ViewHub::answer_all_error(std::string_view about, std::string_view message) {
  for (const auto& [client, peer] : peers_) peer->texts_.add(error_message(about, message));
}

void ViewHub::answer_saved(ClientId client, std::string_view xml) {
  const auto found = peers_.find(client);
  if (found != peers_.end()) found->second->texts_.add(saved_message(xml));
}

std::shared_ptr<const std::string> ViewHub::glb(std::uint64_t structure) {
  const auto scene = std::ranges::find(scenes_, structure, &ViewScene::structure);
  if (scene == scenes_.end()) return nullptr;
  if (!glb_ || glb_structure_ != structure) {
    glb_ = std::make_shared<const std::string>(glb_bytes((*scene)->list, (*scene)->items));
    glb_structure_ = structure;
  }
  return glb_;
}

const std::shared_ptr<const std::string>& ViewHub::message_of(Measured& measured) {
  if (!measured.message) {
    measured.message = std::make_shared<const std::string>(measured.scan ? scan_message(*measured.scan)
                                                                         : image_message(*measured.image));
    measured.scan.reset();
    measured.image.reset();  // the memory of the image goes back to its sensor
  }
  return measured.message;
}

void ViewHub::follow_wants() {
  ViewWants wants;
  for (const auto& [client, peer] : peers_) {
    wants.sensors.insert(peer->looks_at_.begin(), peer->looks_at_.end());
    wants.physics |= peer->wants_physics_;
    wants.plan |= peer->wants_plan_;
  }
  wanted_(std::move(wants));
}

ViewPeer::ViewPeer(ViewHub& hub, ClientId id) : hub_(hub), id_(id) {
  hub_.peers_.emplace(id, this);
  ++hub_.viewers_;
  ++hub_.can_show_;
  hub_.follow_wants();
  hub_.controls_.add({.kind = Control::Kind::look, .client = id});
}

ViewPeer::~ViewPeer() {
  hub_.peers_.erase(id_);
  --hub_.viewers_;
  if (unshown_ < kMaxUnshown) --hub_.can_show_;
  try {
    hub_.follow_wants();
    if (pulls_) hub_.controls_.add({.kind = Control::Kind::pull, .client = id_});
  } catch (const std::bad_alloc&) {  // frames are then copied for one client more than there are, or the pull stays
  }
}

void ViewPeer::sent() {
  if (++unshown_ == kMaxUnshown) --hub_.can_show_;
}

void ViewPeer::shown() {
  if (unshown_ == 0) throw InputError("no frame is under way");
  if (unshown_-- == kMaxUnshown) ++hub_.can_show_;
}

void ViewPeer::add(bool binary, std::string bytes) {
  if (!bytes.empty()) waiting_.push_back({.binary = binary, .head = std::move(bytes), .body = nullptr});
}

// The scene comes first, then what moves, then what was measured.
void ViewPeer::follow_frame() {
  const std::shared_ptr<const ViewFrame> before = std::exchange(seen_, hub_.frame_);
  const ViewFrame& now = *seen_;
  seen_time_ = hub_.time_order_;
  if (before != seen_) {
    if (!same_structure(before.get(), now)) add(false, scene_message(*now.scene, glb_name(now.scene->structure)));
    add(true, transforms_message(before.get(), now));
    add(true, shapes_message(before.get(), now));
    add(false, materials_message(before.get(), now));
    add(false, lights_message(before.get(), now));
    add(false, hidden_message(before.get(), now));
    add(false, environment_message(before.get(), now));
    add(false, values_message(before.get(), now));
    if (wants_physics_ && now.physics) {
      if (std::exchange(bodies_of_, now.scene->structure) != now.scene->structure)
        add(false, bodies_message(*now.scene));
      add(true, physics_message(now));
    }
  }
  std::erase_if(sent_, [&](const auto& each) { return !hub_.measured_.contains(each.first); });
  for (auto& [output, measured] : hub_.measured_) {
    if (!looks_at_.contains(now.scene->sensors[output.first].name)) continue;
    if (std::exchange(sent_[output], measured.order) == measured.order) continue;
    waiting_.push_back({.binary = true, .head = "", .body = hub_.message_of(measured)});
  }
  add(false, frame_message(now, hub_.time_));
  sent();
}

std::optional<WireMessage> ViewPeer::next() {
  if (waiting_.empty()) {
    if (std::optional<WireMessage> text = texts_.next()) return text;
    const bool is_new = hub_.frame_ && (seen_ != hub_.frame_ || seen_time_ != hub_.time_order_);
    if (is_new && unshown_ < kMaxUnshown) follow_frame();
  }
  if (waiting_.empty()) return std::nullopt;
  WireMessage message = std::move(waiting_.front());
  waiting_.pop_front();
  return message;
}

void ViewPeer::look(const std::set<std::uint32_t>& sensors) {
  looks_at_.clear();
  sent_.clear();
  for (const std::uint32_t sensor : sensors) {
    if (seen_ && sensor < seen_->scene->sensors.size()) looks_at_.insert(seen_->scene->sensors[sensor].name);
  }
  hub_.follow_wants();
}

void ViewPeer::request(Control control) {
  control.client = id_;
  if (!hub_.controls_.add(std::move(control))) throw InputError("too many requests wait");
}

void ViewPeer::receive(std::string_view text, bool binary) {
  std::string op = "message";
  try {
    if (binary) throw InputError("expected text");
    const ReceivedJson message = ReceivedJson::parse(text);
    op = message.at("op").get<std::string>();
    using Kind = Control::Kind;
    if (op == "look") {
      std::set<std::uint32_t> sensors;
      for (const ReceivedJson& each : message.at("sensors")) sensors.insert(received_index(each));
      wants_plan_ = message.value("plan", false);
      wants_physics_ = message.value("physics", false);
      look(sensors);
      return request({.kind = Kind::look});
    }
    if (op == "shown") return shown();
    if (op == "set") {
      const std::size_t parameter = received_index(message.at("parameter"));
      return request({.kind = Kind::set, .values = {{parameter, received_number(message.at("value"))}}});
    }
    if (op == "speed") {
      const double factor = received_number(message.at("factor"));
      if (factor < 0) throw InputError("the factor is " + std::to_string(factor) + ", expected 0 or above");
      return request({.kind = Kind::speed, .factor = factor});
    }
    if (op == "pull") {
      const BodyPull pull{.body = received_index(message.at("body")),
                          .body_m = received_point(message.at("at")),
                          .target_m = received_point(message.at("to"))};
      pulls_ = true;
      return request({.kind = Kind::pull, .pull = pull, .request = op});
    }
    if (op == "release") {
      pulls_ = false;
      return request({.kind = Kind::pull, .request = op});
    }
    if (op == "execute")
      return request({.kind = Kind::execute, .text = message.at("xml").get<std::string>(), .request = op});
    for (const auto& [name, kind] : {std::pair("play", Kind::play), std::pair("pause", Kind::pause),
                                     std::pair("step", Kind::step), std::pair("save", Kind::save)}) {
      if (op == name) return request({.kind = kind, .request = op});
    }
    throw InputError("there is no operation " + in_quotes(op));
  } catch (const ReceivedJson::exception&) {
    texts_.add(error_message(op, "the message is not as the protocol says"));
  } catch (const InputError& error) {
    texts_.add(error_message(op, error.what()));
  }
}

}  // namespace simvis::live
