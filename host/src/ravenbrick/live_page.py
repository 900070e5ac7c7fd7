# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A figure with its sliders as a page of this computer.

The page is matplotlib's own WebAgg server, which needs no toolkit; it listens on 127.0.0.1.
"""

from __future__ import annotations

import signal
from collections.abc import Callable
from typing import Any

from ravenbrick.errors import ToolMissingError
from ravenbrick.installation import advice_for_python
from ravenbrick.local_server import LOOPBACK, access_token, is_local

__all__ = ["page_figure", "serve_figure"]


def page_figure(title: str, size: tuple[float, float]) -> Any:
    """An empty figure (inches) for `serve_figure`; raises `ToolMissingError` without tornado."""
    import matplotlib.pyplot as plt

    try:
        plt.switch_backend("WebAgg")
    except ImportError as error:
        raise ToolMissingError(
            f"the live page needs the Python package tornado ({error}); {advice_for_python()}"
        ) from None
    return plt.figure(num=title, figsize=size)


def serve_figure(
    figure: Any,
    port: int,
    tell: Callable[[str], None],
    should_stop: Callable[[], bool],
    step: Callable[[], None] = lambda: None,
    period_ms: int = 200,
) -> None:
    """Serve a `page_figure` and call `step` until `should_stop`; raises `KeyboardInterrupt` when
    interrupted. Call it from the main thread."""
    import matplotlib.pyplot as plt
    from matplotlib import rcParams
    from matplotlib.backends.backend_webagg import WebAggApplication
    from tornado.ioloop import IOLoop
    from tornado.web import ErrorHandler
    from tornado.websocket import WebSocketClosedError

    def tick() -> None:
        step()
        if should_stop():
            IOLoop.current().stop()

    timer = figure.canvas.new_timer(interval=period_ms, callbacks=[(tick, (), {})])
    loop = IOLoop.current()
    interrupts: list[bool] = []

    def interrupt() -> None:
        interrupts.append(True)
        loop.stop()

    def complain(loop: Any, context: dict[str, Any]) -> None:
        """A browser that was closed in the middle of a picture is not a defect."""
        if not isinstance(context.get("exception"), WebSocketClosedError):
            loop.default_exception_handler(context)

    class LocalApplication(WebAggApplication):
        """The page for this machine's own names; a site that is bound to it later gets none."""

        def find_handler(self, request: Any, **options: Any) -> Any:
            if is_local(request.headers.get("Host", "")):
                return super().find_handler(request, **options)
            return self.get_handler_delegate(request, ErrorHandler, {"status_code": 421})

    timer.start()
    rcParams["webagg.port"] = port
    token = access_token()
    LocalApplication.initialize(f"/{token}", address=LOOPBACK)  # type: ignore[no-untyped-call]
    page_port = LocalApplication.port  # type: ignore[attr-defined]
    # Python loses an exception that it raises in a callback of the garbage collection.
    loop.asyncio_loop.add_signal_handler(signal.SIGINT, interrupt)  # type: ignore[attr-defined]
    tell(f"the page is http://{LOOPBACK}:{page_port}/{token}/; Ctrl-C ends")
    loop.asyncio_loop.set_exception_handler(complain)  # type: ignore[attr-defined]
    try:
        loop.start()
    finally:
        loop.asyncio_loop.remove_signal_handler(signal.SIGINT)  # type: ignore[attr-defined]
        timer.stop()
        plt.close(figure)
    if interrupts:
        raise KeyboardInterrupt
