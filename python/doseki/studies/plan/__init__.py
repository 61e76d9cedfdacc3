"""What a study is: its file, the values that it varies, and the points at which it runs."""
