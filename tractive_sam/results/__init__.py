"""What travels: plain data with names and units, below everything that makes or reads it.

A `State` is one solved contact, a `Record` what is kept of it, a `History` all records; a
`Quantity` says what a recorded number is and how it is read off a contact.
"""
