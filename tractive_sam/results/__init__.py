"""What travels: plain data with names and units, below everything that makes or reads it.

A `State` is one solved contact, a `Record` what is kept of it, a `History` all records; a
`Quantity` says what a recorded number is and how it is read off a contact.
"""

import lazy_loader

# Names, listed in __init__.pyi, are looked up when first used: whoever needs a mesh need not read
# scenes, as the rest of the room does.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
