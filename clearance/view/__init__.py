"""A record to look at, live. Not for: files that stay (room `report`)."""

from clearance.view.playback import PAGE, Playback, page_in, show

__all__ = ["PAGE", "Playback", "page_in", "show"]
