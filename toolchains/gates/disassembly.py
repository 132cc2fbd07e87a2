"""Reads a disassembly, and says what each instruction does to the stack and where it may lead to (Thumb-2, RV32)."""

import re
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

from image import Image

LABEL = re.compile(r"([0-9a-f]+) <(.*)>:")
# Arm writes numbers as #4 and comments after @ or ;, RISC-V numbers as 4 and comments after #.
ARM_LINE = re.compile(r"\s*([0-9a-f]+):\t([a-z][\w.]*)(?:\s+([^@;]*))?(?:[@;](.*))?")
RISCV_LINE = re.compile(r"\s*([0-9a-f]+):\t([a-z][\w.]*)(?:\s+([^#]*))?(?:#(.*))?")
DATA = re.compile(r"\s*[0-9a-f]+:\t\.(word|short|byte|2byte|4byte)\s")
TARGET = re.compile(r"([0-9a-f]+) <")

CONDITION = r"(eq|ne|cs|cc|mi|pl|vs|vc|hi|ls|ge|lt|gt|le)"
# They have the stack pointer as first operand, and leave it as it is.
ARM_READS = ("cmp", "cmn", "tst", "teq", "str", "stm", "msr")
RISCV_READS = ("sb", "sh", "sw")
FARTHEST_CONSTANT = 16  # Instructions before its use.
ARM_REGISTER = re.compile(r"(?:r\d+|s[bl]|fp|ip|lr|sp|pc)")


class Instruction(NamedTuple):
    address: int
    mnemonic: str
    operands: str
    comment: str


class Effect(NamedTuple):
    """What an instruction does. Targets are addresses; a call or jump through a register has none."""

    grows: "int | None" = 0  # Bytes that the stack grows by; None if the instruction does not say it.
    by: str = ""  # With None: the register that says it, if one does.
    is_shrinking: bool = False  # With `by`: the register is added.
    falls_through: bool = True
    jump: "int | None" = None
    call: "int | None" = None
    register_call: bool = False
    register_jump: bool = False
    table_jump: bool = False
    returns: bool = False
    switches_stack: bool = False


class Code(NamedTuple):
    """What lies between one label and the next."""

    address: int
    label: str
    instructions: list[Instruction]


def objdump_of(tree: Path) -> str:
    """The objdump of a build tree."""
    match = re.search(r"^CMAKE_OBJDUMP:\w+=(.+)$", (tree / "CMakeCache.txt").read_text(), re.MULTILINE)
    return match[1] if match else sys.exit(f"{tree} knows no objdump")


def disassemble(objdump: str, image: Image) -> list[Code]:
    listing = subprocess.run(
        [objdump, "--disassemble", "--no-show-raw-insn", image.path], capture_output=True, text=True, check=True
    ).stdout
    pattern = ARM_LINE if image.is_arm else RISCV_LINE
    found: list[Code] = []
    for line in listing.splitlines():
        if match := LABEL.match(line):
            # What a compiler names within a function begins with a point.
            if not found or not match[2].startswith("."):
                found.append(Code(int(match[1], 16), match[2], []))
        elif found and not DATA.match(line) and (match := pattern.match(line)):
            found[-1].instructions.append(
                Instruction(int(match[1], 16), match[2], (match[3] or "").strip(), (match[4] or "").strip())
            )
    return [code for code in found if code.instructions]


def effect_of(instruction: Instruction, is_arm: bool) -> Effect:
    return arm_effect(instruction) if is_arm else riscv_effect(instruction)


def target_of(instruction: Instruction) -> "int | None":
    if match := TARGET.search(instruction.operands) or TARGET.search(instruction.comment):
        return int(match[1], 16)
    return None


def arm_effect(instruction: Instruction) -> Effect:
    mnemonic = re.sub(r"\.[nw]$", "", instruction.mnemonic)
    operands = instruction.operands
    if mnemonic in ("cbz", "cbnz") or re.fullmatch(rf"b{CONDITION}", mnemonic):
        return Effect(jump=target_of(instruction))
    if mnemonic in ("b", "bl", "blx", "bx") or re.fullmatch(rf"bx{CONDITION}|bl(x)?{CONDITION}", mnemonic):
        return arm_branch(mnemonic, instruction)
    if mnemonic in ("tbb", "tbh"):
        return Effect(falls_through=False, table_jump=True)
    if mnemonic == "udf":
        return Effect(falls_through=False)
    if match := re.fullmatch(rf"(v?push|v?pop|stmdb|ldmia|ldm|vstmdb|vldmia)({CONDITION})?", mnemonic):
        return arm_multiple(match[1], bool(match[2]), operands)
    if match := re.fullmatch(rf"(str|ldr)(d|b|h)?({CONDITION})?", mnemonic):
        return arm_single(match[1], bool(match[3]), operands)
    if match := re.fullmatch(rf"(add|sub)(s|w)?({CONDITION})?", mnemonic):
        return arm_arithmetic(match[1], bool(match[3]), operands)
    if re.fullmatch(rf"mov(s)?({CONDITION})?", mnemonic):
        return arm_move(operands)
    if "sp!" in operands or (operands.startswith("sp,") and not mnemonic.startswith(ARM_READS)):
        return Effect(grows=None)
    return Effect(switches_stack=mnemonic == "msr" and operands.lower().startswith(("msp", "psp")))


def arm_branch(mnemonic: str, instruction: Instruction) -> Effect:
    conditional = mnemonic not in ("b", "bl", "blx", "bx")
    target = target_of(instruction) if ARM_REGISTER.fullmatch(instruction.operands) is None else None
    if mnemonic.startswith("bl"):
        return Effect(call=target, register_call=target is None)
    if mnemonic.startswith("bx"):
        to_caller = instruction.operands == "lr"
        return Effect(falls_through=conditional, returns=to_caller, register_jump=not to_caller)
    return Effect(falls_through=False, jump=target)


def arm_move(operands: str) -> Effect:
    if operands.startswith("pc,"):
        return Effect(falls_through=False, returns=operands == "pc, lr", register_jump=operands != "pc, lr")
    return Effect(grows=None if operands.startswith("sp,") else 0)


def arm_multiple(mnemonic: str, conditional: bool, operands: str) -> Effect:
    if "{" not in operands or not (mnemonic.endswith(("push", "pop")) or operands.startswith("sp!")):
        returns = "pc" in operands and "{" in operands
        return Effect(falls_through=not returns or conditional, register_jump=returns)
    count = 0
    registers = operands[operands.index("{") + 1 : operands.index("}")].replace(" ", "").split(",")
    for register in registers:
        first, _, last = register.partition("-")
        count += (int(last[1:]) - int(first[1:]) + 1) if last else 1
    size = (8 if registers[0].startswith("d") else 4) * count
    grows = size if mnemonic.endswith("push") or mnemonic.endswith("db") else -size
    returns = grows < 0 and "pc" in registers
    if conditional and grows < 0:
        grows = 0  # As deep as any way there makes it.
    return Effect(grows=grows, falls_through=not returns or conditional, returns=returns)


def arm_single(mnemonic: str, conditional: bool, operands: str) -> Effect:
    registers, _, place = operands.partition("[")
    to_pc = mnemonic == "ldr" and "pc" in registers
    if match := re.fullmatch(r"sp, #-(\d+)\]!", place):
        return Effect(grows=int(match[1]))
    if match := re.fullmatch(r"sp\], #-(\d+)", place):
        return Effect(grows=int(match[1]))
    if match := re.fullmatch(r"sp\], #(\d+)", place):
        return Effect(grows=0 if conditional else -int(match[1]), falls_through=not to_pc or conditional, returns=to_pc)
    if mnemonic == "ldr" and registers.startswith("sp"):
        return Effect(switches_stack=True)
    return Effect(falls_through=not to_pc or conditional, register_jump=to_pc)


def arm_arithmetic(mnemonic: str, conditional: bool, operands: str) -> Effect:
    parts = operands.split(", ")
    if parts[0] != "sp":
        return Effect()
    if match := re.fullmatch(r"#(\d+)", parts[-1]):
        if len(parts) == 3 and parts[1] != "sp":
            return Effect(grows=0)  # Back from a frame pointer: the stack shrinks.
        if mnemonic == "add":
            return Effect(grows=0 if conditional else -int(match[1]))
        return Effect(grows=int(match[1]))
    is_plain = parts[:-1] in (["sp"], ["sp", "sp"]) and ARM_REGISTER.fullmatch(parts[-1]) is not None
    return Effect(grows=None, by=parts[-1] if is_plain else "", is_shrinking=mnemonic == "add")


def riscv_effect(instruction: Instruction) -> Effect:
    mnemonic, operands = instruction.mnemonic, instruction.operands
    target = target_of(instruction)
    if mnemonic in ("ret", "mret", "sret"):
        return Effect(falls_through=False, returns=True)
    if mnemonic in ("j", "tail"):
        return Effect(falls_through=False, jump=target)
    if mnemonic in ("jal", "call"):
        return Effect(call=target)
    if mnemonic == "jr":
        return Effect(falls_through=False, jump=target, register_jump=target is None)
    if mnemonic == "jalr":
        return Effect(call=target, register_call=target is None)
    if mnemonic.startswith("b"):
        return Effect(jump=target)
    if mnemonic in ("unimp", "c.unimp"):
        return Effect(falls_through=False)
    if mnemonic in ("auipc", "lui", "mv", "lw") and operands.startswith("sp,"):
        return Effect(switches_stack=mnemonic != "mv", grows=None if mnemonic == "mv" else 0)
    if mnemonic in ("add", "addi", "sub", "c.addi16sp") and operands.startswith("sp,sp,"):
        if TARGET.search(instruction.comment):
            return Effect()  # The lower half of an address.
        amount = operands.removeprefix("sp,sp,")
        if not re.fullmatch(r"-?\d+", amount):
            return Effect(grows=None, by=amount, is_shrinking=mnemonic == "add")
        return Effect(grows=-int(amount) if mnemonic != "sub" else int(amount))
    if operands.startswith("sp,") and mnemonic not in RISCV_READS:
        if re.fullmatch(r"sp,s0,-\d+", operands) and mnemonic == "addi":
            return Effect()  # Back from a frame pointer: the stack shrinks.
        return Effect(grows=None)
    return Effect()


def constant_in(register: str, before: "list[Instruction]", image: Image) -> "int | None":
    """What instructions put into a register before it is used, if that is a constant, without a branch in between."""
    for at in range(len(before) - 1, max(len(before) - 1 - FARTHEST_CONSTANT, -1), -1):
        instruction = before[at]
        if effect_of(instruction, image.is_arm) != Effect():
            return None
        if not re.match(rf"{register}\b", instruction.operands):
            continue
        value = instruction.operands.partition(",")[2].strip()
        mnemonic = re.sub(r"\.[nw]$", "", instruction.mnemonic)
        if mnemonic in ("mov", "movs", "movw", "li", "c.li") and re.fullmatch(r"#?-?\d+", value):
            return int(value.removeprefix("#"))
        if mnemonic in ("lui", "c.lui") and re.fullmatch(r"0x[0-9a-f]+", value):
            return signed(int(value, 16) << 12)
        if mnemonic in ("add", "addi") and (match := re.fullmatch(rf"{register},(-?\d+)", value)):
            upper = constant_in(register, before[:at], image)
            return None if upper is None else signed(upper + int(match[1]))
        if mnemonic == "ldr" and value.startswith("[pc"):
            return word_at(target_of(instruction), image)
        return None
    return None


def signed(value: int) -> int:
    return (value + 0x80000000) % 0x100000000 - 0x80000000


def word_at(address: "int | None", image: Image) -> "int | None":
    for section in image.sections:
        if address is not None and section.is_allocated and section.address <= address < section.address + section.size:
            return next((signed(word) for at, word in image.words(section) if at == address), None)
    return None
