"""Work for the browser: worker processes, requests that follow the hand, previews."""
