#include "exchange/clients/host.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>
#include <utility>

#include <simvis/error.h>
#include "exchange/clients/shared_object.h"
#include "exchange/clients/shared_words.h"

namespace simvis {

void check_served_name(const std::string& name) {
  const bool fits =
      !name.empty() && name.size() < SIMVIS_SHM_MAX_NAME &&
      name.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-") == std::string::npos;
  if (!fits) {
    throw InputError("\"" + name + "\" can't name a served simulation, expected 1 to " +
                     std::to_string(SIMVIS_SHM_MAX_NAME - 1) + " of A-Z a-z 0-9 . _ -");
  }
}

SharedHost::SharedHost(const std::string& name, SharedAccess access)
    : object_((check_served_name(name), std::make_unique<SharedObject>(name, access))),
      clients_(SIMVIS_SHM_CLIENTS),
      first_parameter_{0} {}
SharedHost::~SharedHost() = default;

void SharedHost::publish() { object_->publish(); }

simvis_text SharedHost::add_text(std::string_view text) {
  simvis_region& strings = object_->layout().strings;
  char* const place = object_->append<char>(strings, text.size());
  text.copy(place, text.size());
  const simvis_text added{strings.count, text.size()};
  object_->publish_count(strings, strings.count + text.size());
  return added;
}

std::size_t SharedHost::add_element(std::string_view name, std::string_view type, std::string_view insertion_point,
                                    std::span<const SharedParameter> parameters) {
  simvis_header& header = object_->layout();
  const std::size_t id = element_removed_.size();
  for (const SharedParameter& parameter : parameters) {
    *object_->append<simvis_parameter>(header.parameters, 1) = {
        .name = add_text(parameter.name),
        .unit = add_text(parameter.unit),
        .min = parameter.min,
        .max = parameter.max,
        .element = id,
        .flags = (parameter.open_min ? 1u * SIMVIS_OPEN_MIN : 0u) | (parameter.open_max ? 1u * SIMVIS_OPEN_MAX : 0u),
        .reserved = 0};
    *object_->append<double>(header.values, 1) = parameter.value;
    *object_->append<double>(header.applied, 1) = parameter.value;
    values_.push_back(parameter.value);
    for (simvis_region* const region : {&header.values, &header.applied, &header.parameters}) {
      object_->publish_count(*region, values_.size());
    }
  }
  *object_->append<simvis_element>(header.elements, 1) = {
      .name = add_text(name),
      .type = add_text(type),
      .insertion_point = add_text(insertion_point),
      .first_parameter = first_parameter_.back(),
      .parameter_count = static_cast<std::uint32_t>(parameters.size()),
      .removed = 0};
  first_parameter_.push_back(values_.size());
  element_removed_.push_back(false);
  object_->publish_count(header.elements, id + 1);
  return id;
}

void SharedHost::remove_element(std::size_t element) {
  simvis_header& header = object_->layout();
  element_removed_.at(element) = true;
  store(reinterpret_cast<simvis_element*>(object_->at(header.elements.offset))[element].removed, 1u);
}

void SharedHost::log(simvis_log_kind kind, std::string_view text, std::uint32_t client, std::uint64_t request) {
  simvis_region& region = object_->layout().log;
  if (kind != SIMVIS_CHANGE && region.count > kLogBytesOfClients) return;
  const std::size_t size = round_up(sizeof(simvis_log_entry) + text.size(), 8);
  char* const place = object_->append<char>(region, size);
  const simvis_log_entry entry{.size = static_cast<std::uint32_t>(size),
                               .kind = static_cast<std::uint32_t>(kind),
                               .request = request,
                               .client = client,
                               .text_size = static_cast<std::uint32_t>(text.size()),
                               .frame = next_frame_};
  std::memcpy(place, &entry, sizeof entry);
  text.copy(place + sizeof entry, text.size());
  object_->publish_count(region, region.count + size);
}

void SharedHost::finish_frame(std::uint64_t next_frame, std::int64_t time_ns) {
  simvis_header& header = object_->shared();
  store_relaxed(header.frame_sequence, ++frame_sequence_);
  std::atomic_thread_fence(std::memory_order_release);
  auto* const applied = reinterpret_cast<std::uint64_t*>(object_->at(object_->layout().applied.offset));
  for (std::size_t i = 0; i < values_.size(); ++i) store_relaxed(applied[i], std::bit_cast<std::uint64_t>(values_[i]));
  store_relaxed(header.frame, ++frames_);
  store_relaxed(header.next_frame, next_frame_ = next_frame);
  store_relaxed(header.time_ns, time_ns);
  store(header.frame_sequence, ++frame_sequence_);
  object_->wake_frame();
}

}  // namespace simvis
