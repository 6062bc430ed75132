#pragma once
// Exports each frame as soon as a run has written it, and passes everything on to another observer.
// An export that fails does not end the run: it is told once, and given up.

#include "taut/results/run.h"
#include "taut/results/sequence_export.h"

namespace taut::app {

class LiveExport : public RunObserver {
 public:
  // Into DIR/FORMAT. `inner` must outlive it. Throws InputError as SequenceExport.
  LiveExport(const ResultsFolder& results, const std::string& format, RunObserver& inner);

  void on_step(const StepReport& record, int steps_total) override {
    inner_.on_step(record, steps_total);
  }
  void on_message(const std::string& text) override { inner_.on_message(text); }
  void on_frame(int frame, int frames_total) override;
  // After the run; true when all is well.
  bool finish();
  const std::filesystem::path& folder() const { return options_.folder; }

 private:
  template <class Action>
  void attempt(const Action& action);

  RunObserver& inner_;
  ResultFrames frames_;
  SequenceExportOptions options_;
  std::unique_ptr<SequenceExport> sequence_;
};

}  // namespace taut::app
