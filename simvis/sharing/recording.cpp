#include "simvis/sharing/recording.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string_view>
#include <system_error>
#include <utility>

#include <simvis/error.h>
#include "engine/base/file_writing.h"
#include "engine/base/input_file.h"
#include "engine/base/output_target.h"
#include "engine/base/read_error.h"
#include "exchange/messages/bag_folder.h"
#include "exchange/messages/mcap_records.h"

namespace simvis {
namespace {

bool is_empty_or_starts_with(const std::filesystem::path& file, std::string_view expected) {
  const InputFile input(file);  // throws for a file that cannot be read, so that it is not replaced
  const Bytes start = input.read(0, std::min(input.size(), expected.size()));
  return std::string_view(reinterpret_cast<const char*>(start.data()), start.size()) == expected || start.empty();
}

void check_replaceable(const std::filesystem::path& file, std::string_view start, const char* kind) {
  const std::filesystem::path target = regular_target(file);
  if (!is_there(target) || is_empty_or_starts_with(target, start)) return;
  throw InputError(file.string() + ": error: exists and is no " + kind + ", expected a new file or one to replace");
}

// The MCAP file, with its folder if that is a bag.
std::filesystem::path data_file(const std::filesystem::path& file) {
  if (!ros::is_bag_folder(file)) return file;
  std::error_code error;
  std::filesystem::create_directory(file.parent_path(), error);
  if (error) throw_file_error(file, "cannot be made", error.value());
  return ros::bag_data(file);
}

}  // namespace

Recording::Recording(const RecordDesc& desc, const BuiltScene& scene)
    : desc_(desc), data_(data_file(desc.file)), lock_(data_), topics_(desc.topics), messages_(*this, scene) {
  check_replaceable(data_, ros::kMcapMagic, "MCAP file");
  if (ros::is_bag_folder(desc.file))
    check_replaceable(ros::bag_metadata(desc.file), "rosbag2_bagfile_information", "metadata of a bag");
}

Recording::~Recording() {
  try {
    finish();
  } catch (...) {  // finish() reports errors, no memory among them; the destructor ignores them
  }
}

// Small messages say how objects are. They are never dropped, and do not wait.
bool Recording::add(ros::MessageJob job) {
  using WhenFull = ros::Recorder::WhenFull;
  const bool is_state = job.kind == ros::MessageJob::Kind::state;
  const WhenFull when_full = is_state ? WhenFull::exceed : desc_.drop ? WhenFull::drop : WhenFull::wait;
  const bool added = recorder_->add(job.held_bytes, when_full, std::move(job.run));
  if (!added) dropped_ += job.messages;
  return added;
}

void Recording::frame(const Frame& frame) {
  if (!recorder_) recorder_.emplace(make_sink());
  messages_.add_frame(frame);
}

std::unique_ptr<ros::RecorderSink> Recording::make_sink() const {
  if (ros::is_bag_folder(desc_.file)) return std::make_unique<ros::BagFolder>(desc_.file);
  return std::make_unique<ros::MessageFile>(data_);
}

RecordReport Recording::finish() {
  if (!recorder_) return {.file = desc_.file};
  messages_.add_paths();
  recorder_->finish();
  if (!ended_early_) warnings_ = unmatched_warnings(name(), topics_);
  return {.file = desc_.file, .messages = recorder_->messages(), .dropped = dropped_, .bytes = recorder_->bytes()};
}

}  // namespace simvis
