"""Reads a linked 32-bit image: its sections, its symbols and the words in it."""

import struct
import sys
from pathlib import Path
from typing import NamedTuple

EM_ARM, EM_RISCV = 40, 243
SHT_SYMTAB, SHT_RELA, SHT_NOBITS, SHT_REL = 2, 4, 8, 9
SHF_WRITE, SHF_ALLOC, SHF_EXECINSTR = 1, 2, 4
STT_FUNC, STT_FILE = 2, 4
SHN_UNDEF = 0
# A word that holds an address.
R_ARM_ABS32, R_RISCV_32 = 2, 1


class Section(NamedTuple):
    name: str
    kind: int
    flags: int
    address: int
    offset: int
    size: int
    link: int
    info: int

    @property
    def is_allocated(self) -> bool:
        return bool(self.flags & SHF_ALLOC)

    @property
    def is_writable(self) -> bool:
        return bool(self.flags & SHF_WRITE)


class Symbol(NamedTuple):
    name: str
    address: int  # Without the bit that marks Thumb code.
    size: int
    kind: int
    section: int
    file: str  # The source of a local symbol, without its folder.

    @property
    def is_defined(self) -> bool:
        return self.section != SHN_UNDEF and self.name != ""


class Image:
    def __init__(self, path: str):
        self.path = path
        self.name = Path(path).name.removesuffix(".elf")
        self.bytes = Path(path).read_bytes()
        if self.bytes[:6] != b"\x7fELF\x01\x01":
            sys.exit(f"{path}: no little-endian 32-bit ELF file")
        header = struct.unpack_from("<HHIIIIIHHHHHH", self.bytes, 16)
        self.machine, entry, sections_at, section_size, count, names = header[1], header[3], header[5], *header[10:13]
        self.is_arm = self.machine == EM_ARM
        self.entry = self.code_address(entry)
        raw = [struct.unpack_from("<IIIIIIIIII", self.bytes, sections_at + i * section_size) for i in range(count)]
        self.sections = [Section("", *fields[1:8]) for fields in raw]
        self.sections = [
            section._replace(name=self._text(self.sections[names], fields[0]))
            for section, fields in zip(self.sections, raw)
        ]
        self.symbols = self._read_symbols()

    def _text(self, strings: Section, at: int) -> str:
        start = strings.offset + at
        return self.bytes[start : self.bytes.index(0, start)].decode()

    def _read_symbols(self) -> list[Symbol]:
        found = []
        file = ""
        for table in self.sections:
            if table.kind != SHT_SYMTAB:
                continue
            for at in range(table.offset, table.offset + table.size, 16):
                name, value, size, info, _, section = struct.unpack_from("<IIIBBH", self.bytes, at)
                text = self._text(self.sections[table.link], name)
                kind, binding = info & 15, info >> 4
                if kind == STT_FILE:
                    file = text
                    continue
                address = self.code_address(value) if kind == STT_FUNC else value
                found.append(Symbol(text, address, size, kind, section, file if binding == 0 else ""))
        return found

    def code_address(self, value: int) -> int:
        return value & ~1 if self.is_arm else value

    def contents(self, section: Section) -> bytes:
        if section.kind == SHT_NOBITS:
            return b""
        return self.bytes[section.offset : section.offset + section.size]

    def words(self, section: Section) -> list[tuple[int, int]]:
        """The aligned words of a section, with their addresses."""
        contents = self.contents(section)
        start = -section.address % 4
        return [
            (section.address + at, struct.unpack_from("<I", contents, at)[0])
            for at in range(start, len(contents) - 3, 4)
        ]

    def pointers(self) -> "set[int] | None":
        """The addresses that words of the image hold; None unless it was linked with --emit-relocs."""
        wanted = R_ARM_ABS32 if self.is_arm else R_RISCV_32
        found: set[int] = set()
        tables = [s for s in self.sections if s.kind in (SHT_REL, SHT_RELA) and self.sections[s.info].is_allocated]
        for table in tables:
            section = self.sections[table.info]
            contents = self.contents(section)
            size = 8 if table.kind == SHT_REL else 12
            for at in range(table.offset, table.offset + table.size, size):
                place, info = struct.unpack_from("<II", self.bytes, at)
                if info & 0xFF == wanted and 0 <= place - section.address <= len(contents) - 4:
                    found.add(struct.unpack_from("<I", contents, place - section.address)[0])
        return found if tables else None
