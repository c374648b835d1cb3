#include "simvis/sharing/recording.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string_view>
#include <utility>

#include <simvis/error.h>
#include "engine/base/input_file.h"
#include "engine/base/output_target.h"
#include "engine/base/read_error.h"
#include "exchange/messages/mcap_records.h"

namespace simvis {
namespace {

bool may_be_replaced(const std::filesystem::path& file) {
  if (!is_there(file)) return true;
  const InputFile input(file);  // a file that cannot be read is not replaced
  const Bytes start = input.read(0, std::min(input.size(), ros::kMcapMagic.size()));
  return std::string_view(reinterpret_cast<const char*>(start.data()), start.size()) == ros::kMcapMagic ||
         start.empty();
}

}  // namespace

Recording::Recording(const RecordDesc& desc, const BuiltScene& scene)
    : desc_(desc), lock_(regular_target(desc.file)), topics_(desc.topics), messages_(*this, scene) {
  if (may_be_replaced(regular_target(desc.file))) return;
  throw InputError(desc.file.string() + ": error: exists and is no MCAP file, expected a new file or one to replace");
}

Recording::~Recording() {
  try {
    finish();
  } catch (...) {  // finish() reports errors, no memory among them; the destructor ignores them
  }
}

// Small messages say how things are. They are never dropped, and do not wait.
bool Recording::add(ros::MessageJob job) {
  using WhenFull = ros::Recorder::WhenFull;
  const bool is_state = job.kind == ros::MessageJob::Kind::state;
  const WhenFull when_full = is_state ? WhenFull::exceed : desc_.drop ? WhenFull::drop : WhenFull::wait;
  const bool added = recorder_->add(job.held_bytes, when_full, std::move(job.run));
  if (!added) dropped_ += job.messages;
  return added;
}

void Recording::frame(const Frame& frame) {
  const bool first = !recorder_;
  if (first) recorder_.emplace(std::make_unique<ros::MessageFile>(desc_.file));
  messages_.add_frame(frame);
  if (first) warnings_ = unmatched_warnings(name(), topics_);
}

RecordReport Recording::finish() {
  if (!recorder_) return {.file = desc_.file};
  messages_.add_paths();
  recorder_->finish();
  return {.file = desc_.file, .messages = recorder_->messages(), .dropped = dropped_, .bytes = recorder_->bytes()};
}

}  // namespace simvis
