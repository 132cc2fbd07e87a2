// What the instrument keeps over a power cut.
#include "emax/app/instrument/instrument.hpp"
#include "emax/app/store/record_store.hpp"
#include "emax/app/store/saved_state.hpp"

namespace emax::app {
namespace {

using scpi::ErrorCode;

/// A record on its way to the store or back.
struct RecordWorkspace {
  std::uint8_t frame[RecordStore::kFrameBytes + kMaxSavedSettingsBytes];
  SavedSettings scratch;
};

}  // namespace

Status Instrument::save_settings(std::uint32_t slot) noexcept {
  const Span<std::uint8_t> all(sequencer_.borrow<RecordWorkspace>().frame);
  const std::size_t size = encode(settings_, sweep_settings_, RecordStore::record_in(all));
  RecordStore store(*ports_.store);
  return store.write(slot, all.first(size + RecordStore::kFrameBytes));
}

Status Instrument::recall_settings(std::uint32_t slot) noexcept {
  RecordWorkspace& work = sequencer_.borrow<RecordWorkspace>();
  const RecordStore store(*ports_.store);
  const StoredRecord record = store.read(slot, Span<std::uint8_t>(work.frame));
  if (record.status != Status::kOk) {
    return record.status;
  }
  const Span<const std::uint8_t> bytes(work.frame, record.bytes);
  const Status status =
      decode(bytes, ports_.analog.format(), work.scratch, settings_, sweep_settings_);
  if (status == Status::kOk) {
    restart_random();
  }
  if (status == Status::kOk && record.is_damaged) {
    session_.status().report(ErrorCode::kSaveRecallMemoryLost,
                             "a copy is damaged: this one may be older");
  }
  return status;
}

// A store that fails costs the memory of a fit, not the fit.
void Instrument::keep_identification() noexcept {
  const EvaluationResults& results = sequencer_.evaluation();
  if (ports_.store == nullptr || is_fit_kept_ || !results.has_fit()) {
    return;
  }
  is_fit_kept_ = true;
  const Span<std::uint8_t> all(sequencer_.borrow<RecordWorkspace>().frame);
  const std::size_t size = encode(identification_of(results), RecordStore::record_in(all));
  RecordStore store(*ports_.store);
  if (store.write(kIdentificationRecord, all.first(size + RecordStore::kFrameBytes)) !=
      Status::kOk) {
    session_.status().report(ErrorCode::kMemoryError, "the fit is not kept over power off");
  }
}

void Instrument::restore_identification() noexcept {
  if (ports_.store == nullptr) {
    return;
  }
  const RecordStore store(*ports_.store);
  const Span<std::uint8_t> space(sequencer_.borrow<RecordWorkspace>().frame);
  const StoredRecord record = store.read(kIdentificationRecord, space);
  if (record.is_damaged) {
    session_.status().report(ErrorCode::kMemoryError,
                             record.status == Status::kOk
                                 ? "a copy is damaged: the fit may be older"
                                 : "the fit that was kept is damaged: lost");
  }
  Identification identification;
  if (record.status == Status::kOk &&
      decode(Span<const std::uint8_t>(space.first(record.bytes)), identification) == Status::kOk) {
    sequencer_.take(identification);
  }
}

}  // namespace emax::app
