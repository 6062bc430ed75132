#include "live_export.h"

#include "taut/base/error.h"

namespace taut::app {

LiveExport::LiveExport(const ResultsFolder& results, const std::string& format, RunObserver& inner)
    : inner_(inner), frames_(results.folder()) {
  options_.format = format;
  options_.folder = results.folder() / format;
  options_.last = frames_.scene().time.frames;
  sequence_ = std::make_unique<SequenceExport>(frames_, options_);
}

template <class Action>
void LiveExport::attempt(const Action& action) {
  if (!sequence_) return;
  try {
    action();
  } catch (const InputError& error) {
    sequence_.reset();
    inner_.on_message(std::string("the export has ended, the run goes on: ") + error.what());
  }
}

void LiveExport::on_frame(int frame, int frames_total) {
  inner_.on_frame(frame, frames_total);
  attempt([&] { sequence_->add_frames_until(frame); });
}

bool LiveExport::finish() {
  attempt([&] { sequence_->finish(); });
  return sequence_ != nullptr;
}

}  // namespace taut::app
