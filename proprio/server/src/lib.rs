//! A server on 127.0.0.1 with threads of its own: the frame of the live page and of the stream for other viewers.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::sync::oneshot;

/// A server that runs until it is dropped, which ends its threads and waits for them.
#[derive(Debug)]
pub struct LocalServer {
    address: SocketAddr,
    listener: Option<TcpListener>,
    stop: Arc<AtomicBool>,
    stop_server: Option<oneshot::Sender<()>>,
    threads: Vec<JoinHandle<()>>,
}

impl LocalServer {
    /// Takes this port of 127.0.0.1; 0: any free one.
    ///
    /// # Errors
    /// The system's, where the port is not free.
    pub fn bind(port: u16) -> io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let stop = Arc::new(AtomicBool::new(false));
        Ok(Self { address, listener: Some(listener), stop, stop_server: None, threads: Vec::new() })
    }

    /// Its address.
    #[must_use]
    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    /// Starts a thread, which ends when the flag that it gets is set.
    ///
    /// # Errors
    /// The system's, where it has no thread left.
    pub fn spawn(&mut self, name: &str, work: impl FnOnce(&AtomicBool) + Send + 'static) -> io::Result<()> {
        let stop = Arc::clone(&self.stop);
        self.threads.push(std::thread::Builder::new().name(name.to_owned()).spawn(move || work(&stop))?);
        Ok(())
    }

    /// Starts the thread that serves connections by `serve`, once.
    ///
    /// # Errors
    /// The system's, where it has no thread left.
    pub fn serve<F: Future<Output = io::Result<()>>>(
        &mut self,
        name: &str,
        serve: impl FnOnce(tokio::net::TcpListener) -> F + Send + 'static,
    ) -> io::Result<()> {
        let Some(listener) = self.listener.take() else { return Ok(()) };
        let (stop_server, stopped) = oneshot::channel();
        self.stop_server = Some(stop_server);
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        self.spawn(name, move |_| {
            let work = async move {
                let listener = tokio::net::TcpListener::from_std(listener)?;
                tokio::select! {
                    served = serve(listener) => served,
                    _ = stopped => Ok(()),
                }
            };
            // A server error cannot be reported at this point.
            let _ = runtime.block_on(work);
            // Do not wait for a client that does not read, nor for long work that it has asked for.
            runtime.shutdown_background();
        })
    }
}

impl Drop for LocalServer {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(stop) = self.stop_server.take() {
            // The server may have ended already.
            let _ = stop.send(());
        }
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

/// Serves one connection to its end, but for a WebSocket, which continues by itself. The head of a request takes at most
/// `head_timeout`.
pub async fn serve_connection<S>(stream: S, router: Router, head_timeout: Duration)
where
    S: AsyncRead + AsyncWrite + Unpin + Send + 'static,
{
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(head_timeout);
    let service = TowerToHyperService::new(router);
    // A client that leaves ends its connection.
    drop(http.serve_connection(TokioIo::new(stream), service).with_upgrades().await);
}
