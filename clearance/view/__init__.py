"""A record to look at, live. Not for: files that stay (room `report`)."""

from clearance.view.playback import Playback, play, show

__all__ = ["Playback", "play", "show"]
