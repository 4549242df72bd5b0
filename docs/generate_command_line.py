"""Write `command-line.md` from the parser: every command, its arguments, its options.

What several commands share (a body from a file, an object and its press) is told once.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable, Iterable

from workbench.cli import command_line
from workbench.cli.body_arguments import add_body_options
from workbench.cli.press_arguments import add_press_options

SHARED: dict[str, Callable[[argparse.ArgumentParser], None]] = {
    "A body from a file": add_body_options,
    "Object, press and solver": add_press_options,
}
"""Heading of the options that several commands take, and what adds them."""
EVERYWHERE = {"-h", "--help", "--project"}
"""Options of all commands, told at the head of the page."""
HEAD = """# The command line

Made from the parser by `make docs`; `workbench COMMAND --help` says the same. Every command also
takes `--project DIR`, the folder that keeps results (default `$WORKBENCH_PROJECT`, else
`.workbench` where you stand); `workbench --version` prints the version. What the files hold that
commands write stands in [formats.md](formats.md), what the options of a press mean in
[contact.md](contact.md).
"""


def page() -> str:
    """The whole page."""
    parts = [HEAD, _exit_codes(), *map(_shared, SHARED)]
    parts += [_command(name, found) for name, found in commands().items()]
    return "\n".join(parts)


def commands() -> dict[str, argparse.ArgumentParser]:
    """Every command that can be given, those of a group by both words."""
    return {
        name: found for name, found in _below(command_line.parser()).items() if not _below(found)
    }


def _below(top: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    found: dict[str, argparse.ArgumentParser] = {}
    for action in top._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, sub in action.choices.items():
                inner = {f"{name} {word}": command for word, command in _below(sub).items()}
                found |= {name: sub, **inner}
    return found


def _exit_codes() -> str:
    introduction = (command_line.__doc__ or "").partition("\n\n")[2]
    return f"{introduction.strip()}\n"


def _shared(title: str) -> str:
    scratch = argparse.ArgumentParser(add_help=False)
    SHARED[title](scratch)
    accepting = [name for name, found in commands().items() if _options(scratch) <= _options(found)]
    named = ", ".join(f"`{name}`" for name in accepting)
    return f"## {title}\n\nOptions of {named}.\n\n{_table(scratch._actions)}"


def _command(name: str, command: argparse.ArgumentParser) -> str:
    taken, links = set(EVERYWHERE), []
    for title, add in SHARED.items():
        scratch = argparse.ArgumentParser(add_help=False)
        add(scratch)
        if _options(scratch) <= _options(command):
            taken |= _options(scratch)
            links.append(f"[{title.lower()}](#{title.lower().replace(',', '').replace(' ', '-')})")
    own = [action for action in command._actions if not set(action.option_strings) & taken]
    lines = [f"## `workbench {name}`", "", command.description or "", ""]
    if links:
        lines += [f"Also takes the options of {' and of '.join(links)}.", ""]
    return "\n".join([*lines, _table(own)] if own else lines)


def _options(parser: argparse.ArgumentParser) -> set[str]:
    return {option for action in parser._actions for option in action.option_strings}


def _table(actions: Iterable[argparse.Action]) -> str:
    rows = [f"| {_spelling(action)} | {_meaning(action)} |" for action in actions]
    return "\n".join(["| | |", "|---|---|", *rows, ""])


def _spelling(action: argparse.Action) -> str:
    value = _value(action)
    if not action.option_strings:
        return f"`{value}`"
    return f"`{' '.join(filter(None, (action.option_strings[-1], value)))}`"


def _value(action: argparse.Action) -> str:
    """What stands behind an option, or in place of an argument."""
    if action.nargs == 0:
        return ""
    name = action.metavar if isinstance(action.metavar, str) else "VALUE"
    if action.nargs == "?":
        name = f"[{name}]"
    return (f"{name}..." if action.nargs == "+" else name).replace("|", "\\|")


def _meaning(action: argparse.Action) -> str:
    """What it does, its choices, and whether it is needed."""
    # Argparse has two percent signs for one.
    words = (action.help or "").replace("%%", "%").replace("|", "\\|")
    if action.choices:
        choices = ", ".join(f"`{choice}`" for choice in action.choices)
        words = f"{choices}; {words}" if words else choices
    if action.required and action.option_strings:
        words = f"needed: {words}"
    return re.sub(r"\s+", " ", words)
