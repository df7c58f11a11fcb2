"""A record to look at, live. Not for: files that stay (room `report`)."""

from clearance.view.playback import Playback, show

__all__ = ["Playback", "show"]
