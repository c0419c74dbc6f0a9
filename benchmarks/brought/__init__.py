"""What people bring: robots of the public, logs of every format, and the page they get, in a browser."""
