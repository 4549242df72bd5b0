"""Starts the browser front: checks the port, guards the server, builds the desk, keeps it running.

One server shows one desk; every tab sees the same. The server answers before the worker lanes are
warm, so a cached design is on screen at once.
"""

from __future__ import annotations

import argparse
import contextlib
import errno
import importlib
import io
import os
import secrets
import signal
import socket
import threading
import webbrowser
from typing import Any

import viser

from ui.desk.desk import Desk
from ui.desk.followers import Followers
from ui.desk.session import Session
from ui.guard import LOOPBACK, Gate, guarded
from ui.links import links, reachable_names
from ui.page.callbacks import run_in_order
from ui.page.editor import Editor
from ui.page.help import Help
from ui.page.incoming import Incoming
from ui.page.theme import Theme
from ui.page.tour import ENLARGED, PRESSED, SHAPED, Tour
from ui.panels.page import pages
from ui.panels.results.page import ResultsPanel
from ui.panels.view.page import ViewPanel
from ui.patches.everywhere import mend_everywhere
from ui.patches.materials import finish
from ui.patches.software_drawing import page_with_script
from ui.patches.style import mend
from ui.tenancy import Tenancy
from workbench.core.base.errors import DesignError, StoreError
from workbench.core.base.version import VERSION
from workbench.live.conductor import Conductor
from workbench.live.lanes import LaneRunner
from workbench.pipeline.first_results import unpack_first
from workbench.project.project import Project

DRAWING = (
    "cv2",
    "scipy.sparse",
    "scipy.spatial",
    "trimesh",
    "manifold3d",
    "geometry.objects.everyday",
    "geometry.objects.indenters",
)
"""What this process draws and chooses objects with, and is slow to import."""


def serve(options: argparse.Namespace, project: Project) -> int:
    """Run the workbench until Ctrl-C; returns the exit code.

    Raises:
        DesignError: If the port is taken or the design cannot be read.
    """
    check_port(options.host, options.port)
    session = Session(project)
    session.open(options.design, unit=options.unit)
    project.sweep()
    local = options.host in (*LOOPBACK, "::1")
    token = None if local else secrets.token_urlsafe(16)
    names = () if local else reachable_names(options.host)
    here, *others = links(names or [options.host], options.port, token)
    # Others can read the lock's file, so the token does not stand there.
    tenancy = Tenancy(project.folder, session, link=here.partition("?")[0])
    holder = tenancy.enter()
    if holder is not None:
        print(
            f"The project {project.folder} is open in another workbench, process {holder.pid}"
            f"{f' at {holder.link}' if holder.link else ''}, since {holder.since}: it is only "
            "shown here, until you take it over in the page",
            flush=True,
        )
    gate = Gate(port=options.port, hosts=(*LOOPBACK, options.host, *names), token=token)
    # From here on: what is refused above leaves the caller's handlers as they were.
    stop = asked_to_stop()
    # viser prints a link of its own, without the token.
    with guarded(gate, page_with_script), contextlib.redirect_stdout(io.StringIO()):
        server = viser.ViserServer(
            host=options.host, port=options.port, label="Sensor workbench", verbose=False
        )
    if server.get_port() != options.port:
        # Another program took the port between the check and the bind.
        server.stop()
        tenancy.leave()
        raise _port_taken(options.port)
    conductor = Conductor(project.store, LaneRunner(project.store))
    threading.Thread(target=warm_up, name="warm-up", daemon=True).start()
    editor = Editor(server)
    tenancy.follow(editor, holder)
    look = {"fast": options.fast_scene, "tour": not options.no_tour}
    desk = build_desk(server, session, conductor, editor, **look)
    entered = desk.guarded(lambda event: desk.replaced())
    tenancy.on_entered = lambda: entered(None)
    desk.on_turn.append(tenancy.turn)
    # The pump already turns: two threads that show the same body would undo each other's work.
    with desk.reports.lock:
        first_look(desk)
    gate.health = lambda: {"ok": True, "version": VERSION, "busy": conductor.busy}
    print(f"The workbench is open at {here}  (Ctrl-C ends it)", flush=True)
    for link in others:
        print(f"                   or at {link}", flush=True)
    if options.open:
        webbrowser.open(here)
    try:
        while not stop.wait(0.2):
            pass
        session.autosave()
    finally:
        conductor.close()
        server.stop()
        tenancy.leave()
    return 0


def build_desk(
    server: Any, session: Session, conductor: Conductor, editor: Editor, *, fast: bool, tour: bool
) -> Desk:
    """Lay out all panels and show what is stored for the design."""
    run_in_order(server)
    gui = server.gui
    gui.main_panel.dock_left()
    # What the strip of stages needs to stand on one row.
    gui.main_panel.set_width(350)
    incoming = Incoming(server, editor)
    Theme(server, incoming)
    with server.atomic():
        mend(gui)
        mend_everywhere(gui)
        gui.add_html(finish())
        found = pages()
        guide = Help(server, incoming, {label: page.help for label, page in found.items()})
        desk = Desk(server, session, conductor, editor, fast=fast)
        Followers(desk)
        tabs = gui.add_tab_group()
        # Without icons eight labels take two rows at most.
        for label, build in ((label, found[label].page.build) for label in found):
            if build is not None:
                with tabs.add_tab(label):
                    desk.panels.append(build(desk))
                    guide.button(label)
        results = ResultsPanel(desk)
        desk.panels += [results, results.maps, ViewPanel(desk, results.dock)]
        with results.dock.add_tab("?"):
            for label, folder in found.items():
                if folder.page.build is None:
                    guide.button(label)
    if tour:
        guide.begin()
    _lead(guide.steps, desk, results)
    editor.on_change = incoming.on_refused = desk.reports.log_soon
    threading.Thread(target=desk.jobs.pump_forever, name="pump", daemon=True).start()
    return desk


def _lead(tour: Tour, desk: Desk, results: ResultsPanel) -> None:
    """Tell the tour what the visitor did."""

    def enlarged(large: bool) -> None:
        if large:
            tour.happened(ENLARGED)

    def shaped(path: str) -> None:
        if path.startswith("design.shape"):
            tour.happened(SHAPED)

    def pressed(stage: str, result: Any) -> None:
        if stage == "shoot":
            tour.happened(PRESSED)

    desk.edited.connect(shaped)
    desk.shown_results.on_result.connect(pressed)
    results.image.size.sized.connect(enlarged)


def first_look(desk: Desk) -> None:
    """Show stored results; a newcomer's first design is pressed in the background.

    Of the design that a new project begins with, results ship.
    """
    begun = any(desk.session.fresh().values()) or desk.editor.is_shut
    begun = begun or _begin_with_what_ships(desk)
    desk.changed()
    if desk.session.notice:
        desk.log(desk.session.notice)
        desk.reports.remark(desk.session.notice)
    if not begun:
        desk.log("first start: pressing the example in the background, a minute or so")
        desk.run("press", ("press", "shoot"))


def _begin_with_what_ships(desk: Desk) -> bool:
    """Put results of the example that ship into an empty store; whether there are any."""
    try:
        wanted = {stage: call.key for stage, call in desk.session.calls().items()}
        put = unpack_first(desk.session.store, wanted)
    except StoreError as error:
        desk.log(f"{error.message}: {error.hint}")
        return False
    if put:
        desk.log("first start: the example's contact and image came with the program")
    return bool(put)


def warm_up() -> None:
    """Import what drawing a result needs: the first result would hold all tabs up for seconds."""
    for module in DRAWING:
        importlib.import_module(module)


def asked_to_stop() -> threading.Event:
    """Set by Ctrl-C or a polite kill, from now on.

    While the page is laid out an exception of a signal may come where Python ignores it, and the
    server would then run on.
    """
    stop = threading.Event()
    for name in (signal.SIGINT, signal.SIGTERM):
        signal.signal(name, lambda *_: stop.set())
    return stop


def check_port(host: str, port: int) -> None:
    """Refuse a port that is taken; viser would silently use the next one.

    Raises:
        DesignError: If the port is taken, out of range or not allowed.
    """
    if not 1 <= port <= 65535:
        raise DesignError(
            f"port {port} is outside 1 to 65535", hint="8080 is the default", at="--port"
        )
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as probe:
        if os.name == "posix":
            # A port in TIME_WAIT after a restart is free for a server.
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            if error.errno == errno.EADDRINUSE:
                raise _port_taken(port) from error
            raise DesignError(
                f"cannot listen on {host}:{port}: {error.strerror}",
                hint="choose another --host or a --port of 1024 and above",
                at="--port",
            ) from error


def _port_taken(port: int) -> DesignError:
    return DesignError(
        f"port {port} is taken by another program",
        hint=f"end that program, or run: workbench serve --port {port + 1}",
        at="--port",
    )
