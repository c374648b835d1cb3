#include "simvis/sharing/recording.h"

#include <filesystem>
#include <fstream>
#include <memory>
#include <utility>

#include <simvis/error.h>
#include "engine/base/output_target.h"
#include "messages/mcap_records.h"

namespace simvis {
namespace {

bool may_be_replaced(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string start(ros::kMcapMagic.size(), '\0');
  stream.read(start.data(), static_cast<std::streamsize>(start.size()));
  return stream.gcount() == 0 || start == ros::kMcapMagic;
}

}  // namespace

Recording::Recording(const RecordDesc& desc, const BuiltScene& scene)
    : desc_(desc), topics_(desc.topics), messages_(*this, scene) {
  // First, because opening a FIFO waits for its writer.
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
void Recording::add(ros::MessageJob job) {
  using WhenFull = ros::Recorder::WhenFull;
  const bool is_state = job.kind == ros::MessageJob::Kind::state;
  const WhenFull when_full = is_state ? WhenFull::exceed : desc_.drop ? WhenFull::drop : WhenFull::wait;
  if (!recorder_->add(job.held_bytes, when_full, std::move(job.run))) dropped_ += job.messages;
}

void Recording::frame(const Frame& frame) {
  const bool first = !recorder_;
  if (first) recorder_.emplace(std::make_unique<ros::MessageFile>(desc_.file));
  messages_.add_frame(frame.scene, frame.time, frame.sensors);
  if (first) warnings_ = unmatched_warnings(name(), topics_);
}

RecordReport Recording::finish() {
  if (!recorder_) return {.file = desc_.file};
  messages_.add_paths();
  recorder_->finish();
  return {.file = desc_.file, .messages = recorder_->messages(), .dropped = dropped_, .bytes = recorder_->bytes()};
}

}  // namespace simvis
