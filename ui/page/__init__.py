"""The page around the 3D view: header, dialogs, help, tour, keys, and widgets' common ground."""
