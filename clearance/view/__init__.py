"""A record to look at, live. Not for: files that stay (room `report`)."""

from clearance.view.server import PAGE, PageServer, page_in, show

__all__ = ["PAGE", "PageServer", "page_in", "show"]
