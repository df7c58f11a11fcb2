"""A record to look at, live. Not for: files that stay (room `report`)."""

from clearance.view.playback import Playback, page_in, show

__all__ = ["Playback", "page_in", "show"]
