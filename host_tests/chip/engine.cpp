#include "chip/engine.hpp"

#include <stdexcept>
#include <string>

namespace emax::chip {
namespace {

/// No program comes here.
constexpr std::uint64_t kNowhere = 0x0BADBAD0;

void check(uc_err error, const char* what) {
  if (error != UC_ERR_OK) {
    throw std::runtime_error(std::string(what) + ": " + uc_strerror(error));
  }
}

template <typename Function>
void* pointer_to(Function function) {
  // The emulator takes functions as pointers to data.
  return reinterpret_cast<void*>(function);
}

}  // namespace

Engine::Engine(Core core, EngineClient& client) : client_(client) {
  uc_engine* engine = nullptr;
  // Without UC_MODE_MCLASS: with it the model is ignored, and M7 has no double precision.
  check(uc_open(UC_ARCH_ARM, UC_MODE_THUMB, &engine), "uc_open");
  engine_.reset(engine);
  const int model = core == Core::kCortexM7 ? UC_CPU_ARM_CORTEX_M7 : UC_CPU_ARM_CORTEX_M4;
  check(uc_ctl_set_cpu_model(engine, model), "uc_ctl_set_cpu_model");
  uc_hook hook = 0;
  check(uc_hook_add(engine, &hook, UC_HOOK_BLOCK, pointer_to(&block_hook), this, 1, 0), "hook");
  check(uc_hook_add(engine, &hook, UC_HOOK_INTR, pointer_to(&interrupt_hook), this, 1, 0), "hook");
  check(uc_hook_add(engine, &hook, UC_HOOK_MEM_INVALID, pointer_to(&invalid_hook), this, 1, 0),
        "hook");
}

void Engine::map_memory(std::uint32_t address, std::size_t bytes, std::uint32_t permissions,
                        std::uint8_t* memory) {
  check(uc_mem_map_ptr(engine_.get(), address, bytes, permissions, memory), "uc_mem_map_ptr");
  memories_.push_back({address, memory, std::vector<std::uint32_t>(bytes / kGranule, permissions),
                       permissions, false});
}

void Engine::map_registers(std::uint32_t address, std::size_t bytes) {
  ranges_.push_back(std::make_unique<Range>(Range{this, address}));
  void* const range = ranges_.back().get();
  check(uc_mmio_map(engine_.get(), address, bytes, &read_hook, range, &write_hook, range),
        "uc_mmio_map");
}

// uc_mem_protect() does not keep a program from reading what it has read before.
bool Engine::protect(std::uint32_t address, std::uint32_t permissions) {
  for (Memory& memory : memories_) {
    const std::size_t granule = (address - memory.address) / kGranule;
    if (address < memory.address || granule >= memory.permissions.size() || memory.hidden) {
      continue;
    }
    std::uint32_t& old = memory.permissions[granule];
    if (old == permissions) {
      return true;
    }
    const std::uint32_t at = address & ~(kGranule - 1);
    if (old != UC_PROT_NONE) {
      check(uc_mem_unmap(engine_.get(), at, kGranule), "uc_mem_unmap");
    }
    if (permissions != UC_PROT_NONE) {
      check(uc_mem_map_ptr(engine_.get(), at, kGranule, permissions,
                           memory.bytes + granule * kGranule),
            "uc_mem_map_ptr");
    }
    old = permissions;
    return true;
  }
  return false;
}

void Engine::protect_all(
    const std::function<std::uint32_t(std::uint32_t, std::uint32_t)>& permissions) {
  for (const Memory& memory : memories_) {
    for (std::size_t i = 0; i < memory.permissions.size(); ++i) {
      const auto at = memory.address + static_cast<std::uint32_t>(i) * kGranule;
      protect(at, permissions(at, memory.otherwise));
    }
  }
}

void Engine::hide(std::uint32_t address, bool hidden) {
  for (Memory& memory : memories_) {
    const std::size_t bytes = memory.permissions.size() * kGranule;
    if (memory.address != address || memory.hidden == hidden) {
      continue;
    }
    for (std::uint32_t at = address; hidden && at < address + bytes; at += kGranule) {
      protect(at, memory.otherwise);
    }
    memory.hidden = hidden;
    check(uc_mem_unmap(engine_.get(), address, bytes), "uc_mem_unmap");
    if (hidden) {
      map_registers(address, bytes);
    } else {
      check(uc_mem_map_ptr(engine_.get(), address, bytes, memory.otherwise, memory.bytes),
            "uc_mem_map_ptr");
    }
    // The protection unit's permissions are asked for anew.
    memory.permissions.assign(memory.permissions.size(), memory.otherwise);
  }
}

void Engine::forget_code() {
  check(uc_ctl(engine_.get(), UC_CTL_WRITE(UC_CTL_TB_FLUSH, 0)), "uc_ctl");
}

std::uint32_t Engine::get(int register_id) const {
  std::uint32_t value = 0;
  check(uc_reg_read(engine_.get(), register_id, &value), "uc_reg_read");
  return value;
}

void Engine::set(int register_id, std::uint32_t value) {
  check(uc_reg_write(engine_.get(), register_id, &value), "uc_reg_write");
}

double Engine::get_double(int register_id) const {
  double value = 0.0;
  check(uc_reg_read(engine_.get(), register_id, &value), "uc_reg_read");
  return value;
}

EngineStop Engine::run(std::uint32_t address) {
  stopped_ = false;
  excepted_ = false;
  const uc_err error = uc_emu_start(engine_.get(), address | 1U, kNowhere, 0, 0);
  if (stopped_) {
    return EngineStop::kBlock;
  }
  if (excepted_) {
    return EngineStop::kException;
  }
  pc_ = get(UC_ARM_REG_PC);
  switch (static_cast<int>(error)) {
    case UC_ERR_OK:
      return EngineStop::kSleep;
    case UC_ERR_READ_UNMAPPED:
    case UC_ERR_READ_PROT:
    case UC_ERR_READ_UNALIGNED:
      return EngineStop::kRead;
    case UC_ERR_WRITE_UNMAPPED:
    case UC_ERR_WRITE_PROT:
    case UC_ERR_WRITE_UNALIGNED:
      return EngineStop::kWrite;
    case UC_ERR_FETCH_UNMAPPED:
    case UC_ERR_FETCH_PROT:
      return EngineStop::kFetch;
    default:
      return EngineStop::kUndefined;
  }
}

void Engine::block_hook(uc_engine* engine, std::uint64_t address, std::uint32_t bytes, void* self) {
  auto& me = *static_cast<Engine*>(self);
  const auto start = static_cast<std::uint32_t>(address);
  if (!me.stopped_ && !me.client_.on_block(start, bytes)) {
    me.stopped_ = true;
    me.pc_ = start;
    uc_emu_stop(engine);
  }
}

void Engine::interrupt_hook(uc_engine* engine, std::uint32_t number, void* self) {
  auto& me = *static_cast<Engine*>(self);
  me.excepted_ = true;
  me.exception_ = number;
  me.pc_ = me.get(UC_ARM_REG_PC);
  uc_emu_stop(engine);
}

bool Engine::invalid_hook(uc_engine*, uc_mem_type, std::uint64_t address, int, std::int64_t,
                          void* self) {
  static_cast<Engine*>(self)->fault_address_ = static_cast<std::uint32_t>(address);
  return false;
}

std::uint64_t Engine::read_hook(uc_engine*, std::uint64_t offset, unsigned bytes, void* range) {
  const auto& where = *static_cast<Range*>(range);
  return where.engine->client_.read_register(where.base + static_cast<std::uint32_t>(offset),
                                             bytes);
}

void Engine::write_hook(uc_engine*, std::uint64_t offset, unsigned bytes, std::uint64_t value,
                        void* range) {
  const auto& where = *static_cast<Range*>(range);
  where.engine->client_.write_register(where.base + static_cast<std::uint32_t>(offset), bytes,
                                       static_cast<std::uint32_t>(value));
}

}  // namespace emax::chip
