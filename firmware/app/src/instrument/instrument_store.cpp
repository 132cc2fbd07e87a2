// What the instrument keeps over a power cut.
#include "emax/app/instrument/instrument.hpp"

namespace emax::app {

Status Instrument::save_settings(std::uint32_t slot) noexcept {
  RecordWorkspace& work = workspace_.record;
  const Span<std::uint8_t> all(work.frame);
  const std::size_t size = encode(settings_, sweep_settings_, RecordStore::record_in(all));
  RecordStore store(*ports_.store);
  return store.write(slot, all.first(size + RecordStore::kFrameBytes));
}

Status Instrument::recall_settings(std::uint32_t slot) noexcept {
  RecordWorkspace& work = workspace_.record;
  const RecordStore store(*ports_.store);
  const StoredRecord record = store.read(slot, Span<std::uint8_t>(work.frame));
  if (record.status != Status::kOk) {
    return record.status;
  }
  const Span<const std::uint8_t> bytes(work.frame, record.bytes);
  const Status status =
      decode(bytes, ports_.analog.format(), work.scratch, settings_, sweep_settings_);
  if (status == Status::kOk) {
    invalidate(Change::kEnergy);
    seed_generator();
  }
  return status;
}

// A store that fails costs the memory of a fit, not the fit.
void Instrument::keep_identification() noexcept {
  if (ports_.store == nullptr || is_fit_kept_ || !evaluation_.has_fit()) {
    return;
  }
  is_fit_kept_ = true;
  const Span<std::uint8_t> all(workspace_.record.frame);
  const std::size_t size = encode(identification_of(evaluation_), RecordStore::record_in(all));
  RecordStore store(*ports_.store);
  if (store.write(kIdentificationRecord, all.first(size + RecordStore::kFrameBytes)) !=
      Status::kOk) {
    session_.status().report(scpi::ErrorCode::kMemoryError, "the fit is not kept over power off");
  }
}

void Instrument::restore_identification() noexcept {
  if (ports_.store == nullptr) {
    return;
  }
  const RecordStore store(*ports_.store);
  const Span<std::uint8_t> space(workspace_.record.frame);
  const StoredRecord record = store.read(kIdentificationRecord, space);
  if (record.status != Status::kOk ||
      decode(Span<const std::uint8_t>(space.first(record.bytes)), identification_) != Status::kOk) {
    return;
  }
  has_identification_ = true;
  device_ = identification_.device;
  origin_ = Origin::kModel;
}

}  // namespace emax::app
