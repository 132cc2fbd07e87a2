"""Proves how deep the stack of a linked image can get, from its call graph.

usage: stack.py --objdump OBJDUMP --calls INDIRECT_CALLS.TXT --levels HANDLERS... --budget FLASH RAM STACK
                --callgraph FOLDER... --image IMAGE

Every instruction of the image is followed with what it does to the stack: that gives the frame of each function and
the depth at each of its calls, for those of the libraries too. gcc's call graph (the .ci files that
-fcallgraph-info=su leaves beside the objects in FOLDER) must agree about the frames, and says where each call through
a pointer stands in the source. The name called there decides which functions it may reach: all in the image's vtables
that have this name, or those that INDIRECT_CALLS.TXT lists.

Proven is the deepest chain from the reset on, plus the worst interrupt of each level of priority on top of it, plus the
worst fault on top of that. HANDLERS are those of one level, as "*::on_console *::on_clock"; all others have one of
their own. A trap handler of RISC-V must not let other interrupts through. Code that changes to another stack must fit
between fault_stack_limit and fault_stack_top. Prints these chains and exits with 1 if the image is over its budget, has
recursion, an array on the stack whose size only the running program knows, or a call whose targets are not known.
"""

import argparse
import fnmatch
import re
import sys
from pathlib import Path
from typing import NamedTuple

import budgets
from disassembly import Instruction, constant_in, disassemble, effect_of, target_of
from image import STT_FUNC, Image

NODE = re.compile(r'node: \{ title: "([^"]*)" label: "(.*?)"')
EDGE = re.compile(r'edge: \{ sourcename: "([^"]*)" targetname: "([^"]*)"(?: label: "([^"]*)")?')
FRAME = re.compile(r"(\d+) bytes \((.*)\)")
INDIRECT = "__indirect_call"
# Instead of functions in INDIRECT_CALLS.TXT: a jump within a function; a pointer that is null in every image.
ITSELF, NOTHING = "itself", "nothing"

# What the processor pushes before a handler of Cortex-M runs, with 4 bytes to align it.
EXCEPTION_FRAME, EXCEPTION_FRAME_WITH_FPU = 32 + 4, 104 + 4
# The places of the vector table: exceptions that preempt interrupts, then interrupts.
VECTORS = "vectors"
FIRST_FAULT, LAST_FAULT = 2, 6
FAULT_STACK = ("fault_stack_limit", "fault_stack_top")
SHOWN = "emax::EnergySearch::step"  # What other people's firmware calls: algo/README.md says how deep it gets.
STACK_THAT_GROWS = 1 << 20
MOST_OF_A_KIND = 5  # Problems that have one cause.


class Place(NamedTuple):
    """Where a call through a pointer stands, and the name called there."""

    file: str
    line: str
    name: str


class Node:
    """What gcc's call graph says of a function, from all objects that have it."""

    def __init__(self) -> None:
        self.label = ""
        self.frame: "int | None" = None
        self.is_dynamic = False
        self.calls: set[str] = set()
        self.places: set[Place] = set()

    def merge(self, other: "Node") -> None:
        self.label = self.label or other.label
        if other.frame is not None:
            self.frame = max(self.frame or 0, other.frame)
        self.is_dynamic |= other.is_dynamic
        self.calls |= other.calls
        self.places |= other.places


class Call(NamedTuple):
    depth: int
    target: int


class Function:
    """Code from one address on, as far as it gets without a call."""

    def __init__(self, address: int, label: str, node: "Node | None"):
        self.address = address
        self.label = label
        self.node = node
        self.frame = 0
        self.calls: set[Call] = set()
        self.register_calls: set[int] = set()  # The depth at each.
        self.register_jumps: set[int] = set()
        self.on_other_stack: set[int] = set()  # What runs once the stack pointer has been set.
        self.has_table = False  # Of places to jump to.
        self.table_depth = 0
        self.grows_unknown = False

    @property
    def name(self) -> str:
        return self.node.label if self.node and self.node.label else self.label


class Graph:
    """gcc's call graph, by source file (for local functions) and symbol."""

    def __init__(self, folders: list[str]):
        self.nodes: dict[tuple[str, str], Node] = {}
        self.sources: dict[str, list[str]] = {}
        files = sorted(file for folder in folders for file in Path(folder).rglob("*.ci"))
        for file in files:
            self._read(file)
        self.shared: dict[str, Node] = {}
        for (_, symbol), node in self.nodes.items():
            self.shared.setdefault(symbol, Node()).merge(node)

    def _read(self, file: Path) -> None:
        for line in file.read_text().splitlines():
            if match := NODE.match(line):
                if frame := FRAME.search(match[2]):
                    node = self._node(match[1])
                    node.label = shortened(match[2].split("\\n")[0])
                    node.frame = max(node.frame or 0, int(frame[1]))
                    node.is_dynamic |= frame[2] == "dynamic"
            elif match := EDGE.match(line):
                node = self._node(match[1])
                if match[2] == INDIRECT:
                    node.places.add(self._place(match[3] or ""))
                else:
                    node.calls.add(match[2].rsplit(":", 1)[-1])

    def _node(self, title: str) -> Node:
        source, _, symbol = title.rpartition(":")
        return self.nodes.setdefault((source.rsplit("/", 1)[-1], symbol), Node())

    # gcc points at the parenthesis after the name called, or where that is a member, at the name itself.
    def _place(self, location: str) -> Place:
        file, line, column = location.rsplit(":", 2) if location.count(":") >= 2 else (location, "", "")
        if file not in self.sources:
            self.sources[file] = Path(file).read_text().splitlines() if Path(file).is_file() else []
        lines = self.sources[file]
        name = ""
        if line and int(line) <= len(lines):
            before, after = lines[int(line) - 1][: int(column) - 1], lines[int(line) - 1][int(column) - 1 :]
            # A pointer to a member may be any virtual function, whatever its own name is.
            if match := re.match(r"\w+", after):
                before += match[0]
            if match := re.search(r"((?:->|\.)\*\s*)?\b(\w+)[\s)]*$", before):
                name = "" if match[1] else match[2]
        return Place(file, line, name)

    def find(self, file: str, symbol: str) -> "Node | None":
        """A local function of this file, or without a file the function that all files share."""
        return self.nodes.get((file, symbol)) if file else self.shared.get(symbol)


def shortened(label: str) -> str:
    """A function without the type that it returns."""
    depth = 0
    start = 0
    for at, character in enumerate(label):
        depth += (character in "<[{") - (character in ">]}")
        if character == "(" and depth == 0:
            break
        if character == " " and depth == 0 and not label.startswith("operator", start):
            start = at + 1
    return label[start:]


class Rule(NamedTuple):
    file: str  # A source file from the root of the project, or a function of a library.
    name: str
    callees: list[str]


def read_rules(path: str) -> list[Rule]:
    rules = []
    for number, line in enumerate(Path(path).read_text().splitlines(), 1):
        line = line.partition("#")[0].strip()
        if not line:
            continue
        where, arrow, callees = line.partition("->")
        file, _, name = where.strip().partition(" ")
        if not arrow or not callees.split():
            sys.exit(f"{path}:{number}: expected '<file> <name> -> <function>...' or '<function> -> itself'")
        rules.append(Rule(file, name.strip(), callees.split()))
    return rules


class Program:
    def __init__(self, image: Image, objdump: str, graph: Graph, rules: list[Rule]):
        self.image = image
        self.rules = rules
        self.problems: list[str] = []
        self.notes: list[str] = []
        codes = disassemble(objdump, image)
        self.instructions = {i.address: i for code in codes for i in code.instructions}
        order = list(self.instructions)
        self.after = dict(zip(order, order[1:]))
        self.codes = {code.address: code for code in codes}
        self.owners = {i.address: code.address for code in codes for i in code.instructions}
        self.fpu = any(i.mnemonic.startswith("v") for i in self.instructions.values())
        self.nodes: dict[int, Node] = {}
        self.by_name: dict[str, set[int]] = {}
        for symbol in image.symbols:
            if symbol.is_defined and symbol.address in self.codes:
                self.by_name.setdefault(symbol.name, set()).add(symbol.address)
                if (node := graph.find(symbol.file, symbol.name)) and node.frame is not None:
                    self.nodes[symbol.address] = node
        self.virtual = self._virtual_functions()
        self.taken = self._taken_functions()
        self.called: set[int] = set()  # Through pointers.
        self.functions: dict[int, Function] = {}

    def function(self, address: int) -> Function:
        if address not in self.functions:
            owner = self.owners.get(address, address)
            label = self.codes[owner].label if owner in self.codes else "?"
            if owner != address:
                label += f"+{address - owner}"
            function = Function(address, label, self.nodes.get(address))
            self.functions[address] = function
            if address not in self.instructions:
                self.problems.append(f"there is no code at {address:#x}")
                return function
            self._follow(function)
            self._compare(function)
            self._resolve(function)
        return self.functions[address]

    # Code of the libraries may go on in that of another label; code that gcc has a node for does not.
    def _is_inside(self, function: Function, address: int) -> bool:
        own, owner = self.owners[function.address], self.owners.get(address)
        return owner == own or (own not in self.nodes and owner is not None and owner not in self.nodes)

    # The depth before each instruction, as deep as any way there makes it.
    def _follow(self, function: Function) -> None:
        depths: dict[int, int] = {}
        own = [i.address for i in self.codes[self.owners[function.address]].instructions]
        work = [(function.address, 0)]
        while work:
            address, depth = work.pop()
            if depth <= depths.get(address, -1):
                continue
            if depth > STACK_THAT_GROWS:
                self.problems.append(f"{function.name} grows the stack in a loop")
                return
            depths[address] = depth
            work += self._step(function, address, depth)
            # What nothing has led to by now is reached through a table, if at all.
            if not work and function.has_table:
                work += [(a, function.table_depth) for a in own if a not in depths][:1]

    def _step(self, function: Function, address: int, depth: int) -> list[tuple[int, int]]:
        effect = effect_of(self.instructions[address], self.image.is_arm)
        if effect.switches_stack:
            function.on_other_stack.add(self.after[address])
            return []
        grows = effect.grows
        if grows is None and effect.by:
            amount = constant_in(effect.by, self._before(address), self.image)
            grows = None if amount is None else -amount if effect.is_shrinking else amount
        function.grows_unknown |= grows is None
        if effect.call is not None:
            function.calls.add(Call(depth, effect.call))
        if effect.register_call:
            function.register_calls.add(depth)
        if effect.register_jump:
            function.register_jumps.add(depth)
        if effect.table_jump or effect.register_jump:
            function.has_table = True
            function.table_depth = max(function.table_depth, depth)
        depth = max(depth + (grows or 0), 0)
        function.frame = max(function.frame, depth)
        following = []
        targets = [effect.jump] if effect.jump is not None else []
        if effect.falls_through and address in self.after:
            following.append(self.after[address])
        for target in targets + following:
            if self._is_inside(function, target):
                continue
            if target in targets or function.node is None:
                function.calls.add(Call(depth, target))
        return [(t, depth) for t in targets + following if self._is_inside(function, t)]

    def _before(self, address: int) -> list[Instruction]:
        """The instructions of the same code up to there."""
        return [i for i in self.codes[self.owners[address]].instructions if i.address < address]

    def _compare(self, function: Function) -> None:
        node = function.node
        if function.grows_unknown:
            self.problems.append(f"{function.name} moves the stack by an amount that is not known")
        if node is None:
            return
        if node.is_dynamic:
            self.problems.append(f"{function.name} has an array on the stack whose size only the running program knows")
        if function.frame != node.frame:
            self.notes.append(f"{function.frame} bytes, not {node.frame}: {function.name}")

    def _virtual_functions(self) -> set[int]:
        found = set()
        for symbol in self.image.symbols:
            if symbol.name.startswith("_ZTV") and symbol.is_defined and symbol.section < len(self.image.sections):
                for address, word in self.image.words(self.image.sections[symbol.section]):
                    if symbol.address <= address < symbol.address + symbol.size:
                        found.add(self.image.code_address(word))
        return found & self.codes.keys()

    # Functions whose addresses are in words of the image, or made by instructions.
    def _taken_functions(self) -> set[int]:
        starts = {s.address for s in self.image.symbols if s.kind == STT_FUNC and s.is_defined}
        pointers = self.image.pointers()
        if pointers is None:
            sys.exit(f"stack: {self.image.path} does not tell where its pointers are; link it with --emit-relocs")
        found = {self.image.code_address(pointer) for pointer in pointers} & starts
        for instruction in self.instructions.values():
            if not instruction.mnemonic.startswith(("j", "b", "call", "tail")):
                found |= {int(address, 16) for address in re.findall(r"([0-9a-f]+) <", instruction.comment)} & starts
        return found & self.codes.keys()

    def _resolve(self, function: Function) -> None:
        depths = function.register_calls | function.register_jumps
        if not depths:
            return
        node = function.node
        if node is None:
            if Rule(function.label, "", [ITSELF]) not in self.rules:
                self.problems.append(f"{function.name} calls or jumps through a register, and is not listed")
            return
        targets = set()
        for place in sorted(node.places):
            found = self._targets(place)
            if found is None:
                self.problems.append(
                    f"{function.name} calls {place.name or 'something'} through a pointer in line {place.line} of "
                    f"{place.file}, and no function is known that this may be"
                )
            targets |= found or set()
        # A function whose address the compiler has put into a register is named in the call graph, too.
        named = {address for name in node.calls for address in self.by_name.get(name, set())}
        targets |= named - {call.target for call in function.calls}
        self.called |= targets
        if function.register_calls and not targets and not node.places:
            self.problems.append(f"{function.name} calls through a register, and its call graph does not say whom")
        function.calls |= {Call(depth, target) for depth in depths for target in targets}

    def _targets(self, place: Place) -> "set[int] | None":
        """The functions that the call may reach, or None if nothing is known of it."""
        listed = [r for r in self.rules if r.name == place.name and r.name and place.file.endswith(r.file)]
        if listed:
            patterns = [pattern for rule in listed for pattern in rule.callees]
            found = {a for a in self.taken if any(self.is_called(a, pattern) for pattern in patterns)}
            return found if found or NOTHING in patterns else None
        return {a for a in self.virtual if place.name and self.is_called(a, f"*::{place.name}")} or None

    def is_called(self, address: int, pattern: str) -> bool:
        name = self.nodes[address].label if address in self.nodes else self.codes[address].label
        return fnmatch.fnmatchcase(name, pattern.replace("[", "[[]") + "(*") or name == pattern

    def deepest(self, address: int) -> "tuple[int, list[Function]]":
        """The most bytes that a call of this function takes, and the chain that takes them."""
        return self._deepest(address, [], {})

    def _deepest(self, address: int, path: list[int], known: dict) -> "tuple[int, list[Function]]":
        if address in known:
            return known[address]
        function = self.function(address)
        if address in path:
            names = [self.functions[a].name for a in [*path[path.index(address) :], address]]
            self.problems.append(f"recursion: {' -> '.join(names)}")
            return 0, []
        best = function.frame, [function]
        for call in sorted(function.calls):
            below, chain = self._deepest(call.target, [*path, address], known)
            if call.depth + below > best[0]:
                best = call.depth + below, [function, *chain]
        known[address] = best
        return best

    def check_pointers(self) -> None:
        """Every function that a pointer may point at must be one that some call reaches."""
        interrupts, faults = self.handlers()
        known = self.virtual | self.called | interrupts | faults | {self.image.entry}
        for address in sorted(self.taken - known)[:MOST_OF_A_KIND]:
            self.problems.append(f"something points at {self.function(address).name}, which no known call reaches")

    def switched(self, chain_start: int) -> set[int]:
        """What a call of this function may run on another stack."""
        found: set[int] = set()
        seen: set[int] = set()
        work = [chain_start]
        while work:
            address = work.pop()
            if address not in seen:
                seen.add(address)
                found |= self.function(address).on_other_stack
                work += [call.target for call in self.function(address).calls]
        return found

    def handlers(self) -> "tuple[set[int], set[int]]":
        """What interrupts run, and what faults run."""
        if not self.image.is_arm:
            return self._trap_handlers(), set()
        table = next((s for s in self.image.symbols if s.name == VECTORS and s.is_defined), None)
        if table is None:
            self.problems.append(f"the vector table, {VECTORS}, is missing")
            return set(), set()
        interrupts, faults = set(), set()
        for address, word in self.image.words(self.image.sections[table.section]):
            number = (address - table.address) // 4
            target = self.image.code_address(word)
            if FIRST_FAULT <= number < table.size // 4 and target in self.codes:
                (faults if number <= LAST_FAULT else interrupts).add(target)
        return interrupts, faults

    def interrupt_levels(self, levels_of_board: list[str]) -> list[set[int]]:
        """The handlers of each level of priority."""
        left = set(self.handlers()[0])
        found = []
        for patterns in map(str.split, levels_of_board):
            shared = {a for a in left if any(self.is_called(a, pattern) for pattern in patterns)}
            found.append(shared)
            left -= shared
        return [level for level in found if level] + [{address} for address in sorted(left)]

    def check_nesting(self) -> None:
        """A trap handler of RISC-V runs to its end before the next one, unless it writes to mstatus."""
        for handler in [] if self.image.is_arm else self.handlers()[0]:
            for function in self.reached(handler):
                code = self.codes[self.owners[function.address]]
                if any(i.mnemonic.startswith("csr") and re.search(r"\bmstatus,", i.operands + ",") and "csrr" != i.mnemonic
                       for i in code.instructions):
                    self.problems.append(f"{function.name} lets interrupts interrupt one another")

    def reached(self, start: int) -> list[Function]:
        """All that a call of this function may run, on whatever stack."""
        found: dict[int, Function] = {}
        work = [start]
        while work:
            address = work.pop()
            if address not in found and address in self.instructions:
                found[address] = self.function(address)
                work += [call.target for call in found[address].calls] + sorted(found[address].on_other_stack)
        return list(found.values())

    # The address that goes to mtvec is made in the instructions before.
    def _trap_handlers(self) -> set[int]:
        found = set()
        for code in self.codes.values():
            for at, instruction in enumerate(code.instructions):
                if instruction.mnemonic == "csrw" and instruction.operands.startswith("mtvec,"):
                    register = instruction.operands.partition(",")[2]
                    made = [i for i in code.instructions[:at] if i.operands.startswith(f"{register},")]
                    target = target_of(made[-1]) if made else None
                    if target in self.codes:
                        found.add(target)
        if not found:
            self.problems.append("no trap handler is put into mtvec")
        return found


class Level(NamedTuple):
    title: str
    pushed: int
    bytes: int
    chain: list[Function]


def levels(program: Program, levels_of_board: list[str]) -> list[Level]:
    """The main stack, and what is piled up there."""
    entry = program.image.entry
    roots = {entry, *program.switched(entry)}
    found = [Level("main", 0, *worst(program, roots))]
    for handlers in program.interrupt_levels(levels_of_board):
        found.append(Level("interrupt", pushed_by(program), *worst(program, handlers)))
    if faults := program.handlers()[1]:
        found.append(Level("fault", pushed_by(program), *worst(program, faults)))
    return found


def worst(program: Program, roots: set[int]) -> "tuple[int, list[Function]]":
    return max((program.deepest(root) for root in sorted(roots)), key=lambda found: found[0])


def pushed_by(program: Program) -> int:
    if not program.image.is_arm:
        return 0
    return EXCEPTION_FRAME_WITH_FPU if program.fpu else EXCEPTION_FRAME


def fault_stack(program: Program) -> "tuple[int, Level] | None":
    """What runs on the stack of the faults, with room for the frame of a fault in there, and the size of that stack."""
    roots = {root for handlers in program.handlers() for handler in handlers for root in program.switched(handler)}
    if not roots:
        return None
    limit, top = (next((s.address for s in program.image.symbols if s.name == name), 0) for name in FAULT_STACK)
    return top - limit, Level("on the stack of the faults", pushed_by(program), *worst(program, roots))


def show(level: Level) -> None:
    by_processor = f" and {level.pushed} by the processor" if level.pushed else ""
    print(f"{level.title}: {level.bytes} bytes{by_processor}")
    for function in level.chain:
        print(f"{function.frame:8} {function.name}")


class Proof(NamedTuple):
    bytes: int
    levels: list[Level]
    functions: int
    functions_of_gcc: int
    notes: list[str]
    problems: list[str]


def prove(image: Image, objdump: str, folders: list[str], calls: str, levels_of_board: list[str]) -> Proof:
    program = Program(image, objdump, Graph(folders), read_rules(calls))
    if image.entry not in program.codes:
        sys.exit(f"stack: {image.path} has no code at its entry")
    if not program.nodes:
        sys.exit("stack: no function of the image has a call graph; compile with -fcallgraph-info=su")
    found = levels(program, levels_of_board)
    proven = sum(level.pushed + level.bytes for level in found)
    if other := fault_stack(program):
        size, level = other
        found.append(level)
        if level.bytes + level.pushed > size:
            needed = level.bytes + level.pushed
            program.problems.append(f"the stack of the faults has {size} bytes, and {needed} are needed")
    for address in sorted(a for a in program.nodes if program.is_called(a, SHOWN)):
        found.append(Level(f"of these, a call of {SHOWN}()", 0, *program.deepest(address)))
    program.check_pointers()
    program.check_nesting()
    functions = program.functions.values()
    of_gcc = sum(1 for function in functions if function.node)
    return Proof(proven, found, len(functions), of_gcc, program.notes, sorted(set(program.problems)))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--objdump", required=True)
    parser.add_argument("--calls", required=True)
    parser.add_argument("--callgraph", nargs="+", required=True, metavar="FOLDER")
    parser.add_argument("--levels", nargs="*", default=[], metavar="HANDLERS")
    budgets.add_option(parser)
    parser.add_argument("--image", required=True)
    arguments = parser.parse_args()

    image = Image(arguments.image)
    proof = prove(image, arguments.objdump, arguments.callgraph, arguments.calls, arguments.levels)
    for level in proof.levels:
        show(level)
    for note in proof.notes:
        print(f"other frame than gcc says: {note}")
    print(f"{proof.functions} functions, {proof.functions_of_gcc} of them with a call graph")
    print(f"proven: {proof.bytes} bytes of stack")
    problems = proof.problems + budgets.judge(arguments.budget, {"stack": proof.bytes})
    for problem in problems:
        print(f"{image.name}: {problem}")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
