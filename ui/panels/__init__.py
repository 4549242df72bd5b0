"""One folder of widgets each; they write to the session and show what the desk tells them."""
