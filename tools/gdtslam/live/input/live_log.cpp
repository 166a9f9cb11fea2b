#include "live_log.hpp"

#include <utility>
#include <vector>

#include "scan_queue.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

/// A log that tells what its input lost, too.
class ReportingLog final : public LogReader {
 public:
  ReportingLog(std::unique_ptr<LogReader> log, std::shared_ptr<LiveInput> input)
      : input_(std::move(input)), log_(std::move(log)) {}
  std::optional<LogRecord> next() override { return log_->next(); }
  [[nodiscard]] double progress() const override { return log_->progress(); }
  [[nodiscard]] const std::vector<Warning>& warnings() const override {
    warnings_ = log_->warnings();
    for (Warning& warning : input_->warnings()) warnings_.push_back(std::move(warning));
    return warnings_;
  }

 private:
  std::shared_ptr<LiveInput> input_;  // longer than the log, which reads it
  std::unique_ptr<LogReader> log_;
  mutable std::vector<Warning> warnings_;
};

}  // namespace

LiveLog live_log_of(std::shared_ptr<LiveInput> input, std::size_t queue) {
  return [input = std::move(input), queue](const ReadOptions& options) -> std::unique_ptr<LogReader> {
    std::unique_ptr<LogReader> log =
        open_log_of_bytes([input](std::span<char> target) { return input->read(target); }, input->name(), options);
    if (queue > 0) {
      log = std::make_unique<ScanQueue>(
          std::move(log), queue, [] { return interrupted(); }, [input] { input->close(); });
    }
    return std::make_unique<ReportingLog>(std::move(log), input);
  };
}

}  // namespace gdtslam
