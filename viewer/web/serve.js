// The page of `pbr-viewer serve`: a view that fills it, and the socket to it.
const CONFIG = JSON.parse(document.getElementById("config").textContent);
const address = new URL(`${location.pathname.replace(/\/$/, "")}/view`, location.href);
address.protocol = address.protocol.replace("http", "ws");
let socket = null, words = null, failures = 0;
const send = (message) => { if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message)); };
const view = startView(document.getElementById("view"), CONFIG, send);

function connect() {
  socket = new WebSocket(address);
  socket.binaryType = "arraybuffer";
  socket.onopen = () => { failures = 0; view.tellSize(); };
  socket.onmessage = ({ data }) => {
    if (typeof data === "string") {
      words = JSON.parse(data);
      if (!words.hasPicture) view.show(words, null);
    } else view.show(words, data);
  };
  socket.onclose = () => {
    failures += 1;
    view.say(failures < 30 ? "The connection is lost. Trying again …" : "The connection is lost. Load the page again.");
    if (failures < 30) setTimeout(connect, 1000);
  };
}
connect();
document.getElementById("view").focus();
