#include "program/live/message_outlet.h"

#include <utility>

namespace simvis::live {
namespace {

class HubSink : public ros::MessageSink {
 public:
  explicit HubSink(FoxgloveHub& hub) : hub_(hub) {}

 protected:
  void put(const ros::Topic& topic, std::int64_t time_ns, std::string_view bytes) override {
    hub_.publish(topic, time_ns, bytes);
  }

 private:
  FoxgloveHub& hub_;
};

}  // namespace

// Refuses messages that are written at the end: clients of a running view never get them.
bool LiveOutlet::wants(const ros::Topic& topic, ros::TopicForm form) {
  if (form == ros::TopicForm::at_end) return false;
  if (known_.insert(topic.name).second) new_topics_.push_back(topic);
  return topic.durability == ros::Durability::latched || hub_.wanted.contains(topic.name);
}

bool LiveOutlet::add(ros::MessageJob job) {
  if (job.kind == ros::MessageJob::Kind::measurement && *under_way_ >= kMaxUnderWay) return false;
  jobs_.push_back(std::move(job));
  return true;
}

std::function<void()> LiveOutlet::take_batch() {
  if (jobs_.empty() && new_topics_.empty()) return {};
  ++*under_way_;
  return
      [&hub = hub_, under_way = under_way_, topics = std::exchange(new_topics_, {}), jobs = std::exchange(jobs_, {})] {
        for (const ros::Topic& topic : topics) hub.advertise(topic);
        HubSink sink(hub);
        for (const ros::MessageJob& job : jobs) job.run(sink);
        --*under_way;
      };
}

}  // namespace simvis::live
